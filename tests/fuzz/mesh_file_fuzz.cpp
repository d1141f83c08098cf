// Scene files of the other formats: the first byte chooses OBJ, PLY, STL or OFF.
#include <array>

#include "server/scene/load.h"
#include "shared/base/log.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

constexpr std::array kNames{"t.obj", "t.ply", "t.stl", "t.off"};

std::string seed(std::string_view name, const std::string& contents) {
  return input_named(name, kNames, contents);
}

/// One triangle: 80 bytes of title, a count, and 50 bytes a facet.
std::string binary_stl() {
  std::string stl(80, ' ');
  const std::uint32_t facets = 1;
  stl.append(reinterpret_cast<const char*>(&facets), sizeof facets);
  for (const float number : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F})
    stl.append(reinterpret_cast<const char*>(&number), sizeof number);
  return stl + std::string(2, '\0');
}

/// The same triangle as a list of bytes and ints after a text header.
std::string binary_ply() {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F})
    ply.append(reinterpret_cast<const char*>(&number), sizeof number);
  ply += '\3';
  for (const std::int32_t index : {0, 1, 2})
    ply.append(reinterpret_cast<const char*>(&index), sizeof index);
  return ply;
}

}  // namespace

void try_input(Input input) {
  if (input.empty()) return;
  base::set_log_level(base::LogLevel::Error);
  const NamedContents chosen = choose_name(input, kNames);
  InputFile file(chosen.name);
  (void)scene::load_scene(file.write(chosen.contents));
}

std::vector<std::string> seeds() {
  return {seed("t.obj",
               "mtllib t.mtl\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
               "usemtl x\nf 1/1/1 2/1/1 3/1/1\nf -3 -2 -1\n"),
          seed("t.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
          seed("t.stl",
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
               "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n"),
          seed("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
          seed("t.stl", binary_stl()),
          seed("t.ply", binary_ply())};
}

}  // namespace macula::fuzz
