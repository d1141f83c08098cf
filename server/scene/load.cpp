#include "server/scene/load.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "server/scene/built_in/scenes.h"
#include "shared/base/text.h"

namespace macula::scene {
namespace {

constexpr std::uint64_t kSeed = 1;

constexpr std::array kBuiltIn{
    BuiltIn{"cornell", "the Cornell box at room scale, one area light, Lambertian",
            built_in::cornell},
    BuiltIn{"posts", "textured room with objects at 0.7 to 4 m and thin posts, for reprojection",
            built_in::posts},
};

std::string names_of_built_in_scenes() {
  std::string names;
  for (const BuiltIn& entry : kBuiltIn)
    names += std::string(names.empty() ? "" : ", ").append(entry.name);
  return names;
}

}  // namespace

std::span<const BuiltIn> built_in_scenes() {
  return kBuiltIn;
}

Result<std::shared_ptr<const Scene>> load_scene(const std::string& name_or_path) {
  for (const BuiltIn& entry : kBuiltIn) {
    if (entry.name == name_or_path) return std::make_shared<const Scene>(entry.make(kSeed));
  }
  return base::bad_input("no such scene", name_or_path,
                         "a file ending in .gltf or .glb, or one of " + names_of_built_in_scenes());
}

std::string describe_built_in_scenes() {
  std::ostringstream text;
  for (const BuiltIn& entry : kBuiltIn) {
    text << std::left << std::setw(10) << entry.name << entry.summary << '\n'
         << std::setw(10) << "" << describe(entry.make(kSeed)) << '\n';
  }
  return std::move(text).str();
}

}  // namespace macula::scene
