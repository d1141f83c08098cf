// glTF scenes: the first byte chooses text or binary.
#include <array>

#include "server/scene/load.h"
#include "shared/base/log.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/server/scene/gltf_file.h"

namespace macula::fuzz {
namespace {

constexpr std::array kNames{"t.gltf", "t.glb"};

}  // namespace

void try_input(Input input) {
  if (input.empty()) return;
  base::set_log_level(base::LogLevel::Error);
  const NamedContents chosen = choose_name(input, kNames);
  InputFile file(chosen.name);
  std::ofstream(file.folder() / "t.bin", std::ios::binary) << scene::test::triangle_bytes();
  (void)scene::load_scene(file.write(chosen.contents));
}

std::vector<std::string> seeds() {
  return {input_named("t.gltf", kNames, scene::test::triangle_json()),
          input_named("t.glb", kNames, scene::test::triangle_glb())};
}

}  // namespace macula::fuzz
