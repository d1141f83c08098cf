// Scene files of the other formats: the first byte chooses OBJ, PLY, STL or OFF.
#include <array>

#include "server/scene/load.h"
#include "shared/base/log.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

constexpr std::array kNames{"t.obj", "t.ply", "t.stl", "t.off"};

std::string seed(std::size_t kind, const std::string& contents) {
  return static_cast<char>(kind) + contents;
}

}  // namespace

void try_input(Input input) {
  if (input.empty()) return;
  base::set_log_level(base::LogLevel::Error);
  const std::string name = kNames[input[0] % kNames.size()];
  InputFile file(name);
  (void)scene::load_scene(file.write(as_text(input).substr(1)));
}

std::vector<std::string> seeds() {
  return {seed(0,
               "mtllib t.mtl\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
               "usemtl x\nf 1/1/1 2/1/1 3/1/1\nf -3 -2 -1\n"),
          seed(3,
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
          seed(4,
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
               "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n"),
          seed(3, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")};
}

}  // namespace macula::fuzz
