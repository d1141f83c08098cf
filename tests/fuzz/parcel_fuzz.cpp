// What a confined importer hands over: whoever has taken it over writes whatever bytes it likes.
#include "server/scene/assimp/make_scene.h"
#include "server/scene/assimp/parcel.h"
#include "shared/base/log.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {
namespace {

using namespace scene::assimp;

Parcel small_parcel() {
  Parcel parcel;
  parcel.materials.push_back({"paint", {}, {"paint.png", 1, 2}, {}, {}});
  parcel.materials.push_back({"lamp", {.emission = Rgb{4.0F}}, {}, {}, {}});
  parcel.meshes.push_back({"wall",
                           1,
                           {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                           {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
                           {{0, 0}, {1, 0}, {0, 1}},
                           {{0, 1, 2}}});
  parcel.instances.push_back({0, DMat4{1.0}});
  parcel.lights.push_back({1, Rgb{1.0F}, {0, 2, 0}, {0, -1, 0}, 0.2, 0.5});
  parcel.cameras.push_back({"front", {0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 1.0});
  parcel.warnings = {"a note"};
  parcel.meters_per_unit = 0.01;
  return parcel;
}

std::string text_of(const scene::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void try_input(Input input) {
  base::set_log_level(base::LogLevel::Error);
  const std::string path = "/nowhere/t.obj";
  Result<Parcel> parcel = decode({as_bytes(input).begin(), as_bytes(input).end()}, path);
  if (!parcel) return;
  const auto scene = make_scene(path, std::move(*parcel));
  if (!scene) return;
  for (const scene::Mesh& mesh : scene->meshes)
    for (const UVec3& triangle : mesh.triangles)
      require(std::max({triangle.x, triangle.y, triangle.z}) < mesh.positions.size(),
              "a triangle beyond its mesh's vertices");
}

std::vector<std::string> seeds() {
  Parcel untextured = small_parcel();
  untextured.materials.front().base_color = {};
  return {text_of(encode(untextured)), text_of(encode(small_parcel())),
          text_of(encode(base::bad_input("a sentence", "t.obj", "a remedy")))};
}

}  // namespace macula::fuzz
