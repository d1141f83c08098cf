// Parcel: what one file says, as bytes between the process that parsed it and the one that keeps
// it. Plain numbers in this machine's order. Nothing in a decoded parcel is believed yet but its
// sizes: import.cpp checks the rest.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/files.h"
#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/math/vec.h"

namespace macula::scene::assimp {

/// Which edge rule a texture asks for; the values of scene::Wrap.
struct ParcelTexture {
  std::string path;  ///< as the file names it; empty: none
  std::uint8_t wrap_u = 0, wrap_v = 0;
};

struct MaterialNumbers {
  Rgb base_color{1.0F};
  float alpha = 1.0F;
  float metallic = 0.0F, roughness = 1.0F;
  float specular = 0.0F;
  Rgb specular_color{1.0F};
  Rgb emission{0.0F};
  std::uint32_t double_sided = 0;
};

struct ParcelMaterial {
  std::string name;
  MaterialNumbers numbers;
  ParcelTexture base_color, alpha, emission;
};

struct ParcelMesh {
  std::string name;
  std::uint32_t material = 0;
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> texcoords;
  std::vector<UVec3> triangles;
};

struct ParcelInstance {
  std::uint32_t mesh = 0;
  DMat4 world_from_object{1.0};
};

struct ParcelLight {
  std::uint32_t kind = 0;  ///< the values of scene::LightKind
  Rgb intensity{0.0F};
  DVec3 position{0.0};
  DVec3 direction{0.0};
  double inner_cone_rad = 0.0, outer_cone_rad = 0.0;
};

struct ParcelCamera {
  std::string name;
  DVec3 position{0.0}, direction{0.0}, up{0.0};
  double vertical_fov_rad = 0.0;
};

struct Parcel {
  std::vector<ParcelMaterial> materials;
  std::vector<ParcelMesh> meshes;
  std::vector<ParcelInstance> instances;
  std::vector<ParcelLight> lights;
  std::vector<ParcelCamera> cameras;
  std::vector<std::string> warnings;
  double meters_per_unit = 0.0;  ///< 0: the file does not say
};

Bytes encode(const Result<Parcel>& parcel);
/// The parcel, the error that was sent in its place, or one that names `place` for bytes that are
/// neither.
Result<Parcel> decode(const Bytes& bytes, const std::string& place);

}  // namespace macula::scene::assimp
