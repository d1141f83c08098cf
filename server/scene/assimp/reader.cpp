#include "server/scene/assimp/reader.h"

#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "server/scene/assimp/folder_io.h"
#include "server/scene/assimp/read_materials.h"
#include "server/scene/scene.h"
#include "shared/base/text.h"

namespace macula::scene::assimp {
namespace {

constexpr std::array kFormats{
    Format{".obj", Materials::FromFile}, Format{".ply", Materials::Plain},
    Format{".stl", Materials::Plain},    Format{".off", Materials::Plain},
    Format{".fbx", Materials::FromFile}, Format{".dae", Materials::FromFile},
    Format{".3ds", Materials::FromFile},
};

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.substr(0, 300);
}

/// A file is read by the importer of its suffix or by none: assimp would otherwise try them all.
void keep_only(Assimp::Importer& importer, const std::string& suffix) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    std::set<std::string> suffixes;
    importer.GetImporter(i)->GetExtensionList(suffixes);
    if (!suffixes.contains(suffix.substr(1))) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) importer.UnregisterLoader(other);
}

DMat4 matrix_of(const aiMatrix4x4& m) {
  DMat4 result;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      result[static_cast<int>(column)][static_cast<int>(row)] = m[row][column];
    }
  }
  return result;
}

Vec3 vector_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

class SceneReader {
 public:
  SceneReader(const aiScene& from, const Format& format) : from_(from), format_(format) {}

  Parcel read() {
    warn_about_the_file();
    read_materials();
    for (unsigned i = 0; i < from_.mNumMeshes; ++i) read_mesh(*from_.mMeshes[i]);
    walk();
    for (unsigned i = 0; i < from_.mNumLights; ++i) read_light(*from_.mLights[i]);
    for (unsigned i = 0; i < from_.mNumCameras; ++i) read_camera(*from_.mCameras[i]);
    parcel_.warnings = warnings_.sentences();
    return std::move(parcel_);
  }

 private:
  void warn_about_the_file();
  void read_materials();
  void read_mesh(const aiMesh& from);
  void walk();
  void read_light(const aiLight& from);
  void read_camera(const aiCamera& from);
  DMat4 node_called(const aiString& name) const {
    const auto found = world_from_node_.find(name.C_Str());
    return found == world_from_node_.end() ? DMat4{1.0} : found->second;
  }

  const aiScene& from_;
  const Format& format_;
  Warnings warnings_;
  Parcel parcel_;
  std::map<std::string, DMat4> world_from_node_;
};

void SceneReader::warn_about_the_file() {
  if (from_.mNumAnimations > 0) warnings_.add("animations are ignored: the scene stands still");
  for (unsigned i = 0; i < from_.mNumMeshes; ++i) {
    if (from_.mMeshes[i]->HasBones())
      warnings_.add("skins are ignored: meshes keep their base shape");
    if (from_.mMeshes[i]->HasVertexColors(0)) warnings_.add("colours of vertices are ignored");
  }
  double unit_cm = 0.0;
  float single_cm = 0.0F;
  if (from_.mMetaData == nullptr) return;
  if (from_.mMetaData->Get("UnitScaleFactor", single_cm)) unit_cm = static_cast<double>(single_cm);
  if (from_.mMetaData->Get("UnitScaleFactor", unit_cm) || unit_cm > 0.0) {
    parcel_.meters_per_unit = 0.01 * unit_cm;
  }
}

void SceneReader::read_materials() {
  if (format_.materials == Materials::Plain) {
    parcel_.materials.push_back(plain_material());
    warnings_.add("the format has no materials: a Lambertian grey of 80 % is assumed");
    return;
  }
  for (unsigned i = 0; i < from_.mNumMaterials; ++i) {
    parcel_.materials.push_back(read_material(*from_.mMaterials[i], warnings_));
  }
}

void SceneReader::read_mesh(const aiMesh& from) {
  ParcelMesh mesh;
  mesh.name = from.mName.C_Str();
  mesh.material = format_.materials == Materials::Plain ? 0 : from.mMaterialIndex;
  mesh.positions.reserve(from.mNumVertices);
  for (unsigned v = 0; v < from.mNumVertices; ++v) {
    mesh.positions.push_back(vector_of(from.mVertices[v]));
    if (from.HasNormals()) mesh.normals.push_back(vector_of(from.mNormals[v]));
    if (from.HasTextureCoords(0)) {
      mesh.texcoords.emplace_back(from.mTextureCoords[0][v].x, from.mTextureCoords[0][v].y);
    }
  }
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices == 3) {
      mesh.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
    } else {
      warnings_.add("points and lines are ignored");
    }
  }
  parcel_.meshes.push_back(std::move(mesh));
}

/// Iterative: a chain of nodes of any length costs no stack.
void SceneReader::walk() {
  struct Visit {
    const aiNode* node;
    DMat4 world_from_parent;
  };
  std::vector<Visit> pending{{from_.mRootNode, DMat4{1.0}}};
  while (!pending.empty()) {
    const Visit visit = pending.back();
    pending.pop_back();
    const DMat4 world_from_node = visit.world_from_parent * matrix_of(visit.node->mTransformation);
    world_from_node_.emplace(visit.node->mName.C_Str(), world_from_node);
    for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
      parcel_.instances.push_back({visit.node->mMeshes[i], world_from_node});
    }
    for (unsigned i = visit.node->mNumChildren; i-- > 0;) {
      pending.push_back({visit.node->mChildren[i], world_from_node});
    }
  }
}

void SceneReader::read_light(const aiLight& from) {
  ParcelLight light;
  switch (from.mType) {
    case aiLightSource_POINT:
      light.kind = static_cast<std::uint32_t>(LightKind::Point);
      break;
    case aiLightSource_SPOT:
      light.kind = static_cast<std::uint32_t>(LightKind::Spot);
      break;
    case aiLightSource_DIRECTIONAL:
      light.kind = static_cast<std::uint32_t>(LightKind::Directional);
      break;
    default:
      return warnings_.add("lights that are neither point, spot nor directional are ignored");
  }
  const DMat4 world = node_called(from.mName);
  light.intensity = {from.mColorDiffuse.r, from.mColorDiffuse.g, from.mColorDiffuse.b};
  light.position = DVec3(world * DVec4(DVec3(vector_of(from.mPosition)), 1.0));
  light.direction = DVec3(world * DVec4(DVec3(vector_of(from.mDirection)), 0.0));
  light.inner_cone_rad = 0.5 * static_cast<double>(from.mAngleInnerCone);
  light.outer_cone_rad = 0.5 * static_cast<double>(from.mAngleOuterCone);
  warnings_.add("intensities of lights are taken as W/sr and W/m^2; their attenuation is ignored");
  parcel_.lights.push_back(light);
}

void SceneReader::read_camera(const aiCamera& from) {
  if (from.mOrthographicWidth > 0.0F) return warnings_.add("orthographic cameras are ignored");
  const DMat4 world = node_called(from.mName);
  ParcelCamera camera;
  camera.name = from.mName.C_Str();
  camera.position = DVec3(world * DVec4(DVec3(vector_of(from.mPosition)), 1.0));
  camera.direction = DVec3(world * DVec4(DVec3(vector_of(from.mLookAt)), 0.0));
  camera.up = DVec3(world * DVec4(DVec3(vector_of(from.mUp)), 0.0));
  const double aspect = from.mAspect > 0.0F ? static_cast<double>(from.mAspect) : 1.0;
  const double half = std::tan(0.5 * static_cast<double>(from.mHorizontalFOV));
  camera.vertical_fov_rad = 2.0 * std::atan(half / aspect);
  parcel_.cameras.push_back(std::move(camera));
}

}  // namespace

std::span<const Format> formats() {
  return kFormats;
}

const Format* find_format(const std::string& path) {
  const std::string suffix = lower_case(std::filesystem::path(path).extension().string());
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const Format& format) { return format.suffix == suffix; });
  return found == kFormats.end() ? nullptr : &*found;
}

Result<Parcel> read_parcel(const std::string& path, const Format& format) {
  constexpr unsigned kSteps = aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                              aiProcess_SortByPType | aiProcess_JoinIdenticalVertices |
                              aiProcess_FlipUVs;
  Assimp::Importer importer;
  keep_only(importer, std::string(format.suffix));
  auto* files = new FolderIo(SceneFolder(path));  // owned by the importer
  importer.SetIOHandler(files);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(std::filesystem::path(path).filename().string(), kSteps);
  if (files->refused()) return tl::unexpected(*files->refused());
  const std::string complaint = importer.GetErrorString();
  if (complaint.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  if (scene == nullptr || scene->mRootNode == nullptr) {
    return base::bad_input(one_line(complaint.empty() ? "nothing can be read" : complaint), path,
                           "it must be a valid file of its format; best export glTF");
  }
  Parcel parcel = SceneReader(*scene, format).read();
  for (const std::string& file : files->missing()) {
    parcel.warnings.push_back(base::concat("the file '", one_line(file), "' is missing"));
  }
  return parcel;
}

}  // namespace macula::scene::assimp
