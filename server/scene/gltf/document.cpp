#include "server/scene/gltf/document.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <optional>
#include <span>

#include "server/scene/json_guard.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

constexpr std::size_t kMaxJsonDepth = 64;
/// Bounds what the parser allocates: about 1 kB an object, some 50 bytes a number.
constexpr std::size_t kMaxJsonObjects = 250'000;
constexpr std::size_t kMaxJsonValues = 4'000'000;

constexpr std::array<std::string_view, 4> kKnownExtensions{
    "KHR_materials_emissive_strength", "KHR_materials_specular", "KHR_texture_transform",
    "KHR_lights_punctual"};

constexpr const char* kValidFile = "it must be a valid glTF 2.0 file";

/// tinygltf reports on several lines; we say it on one.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  return text.substr(0, 300);
}

std::uint32_t little_endian_32(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;)
    value = (value << 8) | std::to_integer<std::uint32_t>(bytes[offset + i]);
  return value;
}

bool is_binary(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

/// A .glb whose header and chunks lie inside the file: its JSON text. The checks are ours because
/// the parser trusts the second chunk's length by eight bytes too many.
Result<std::string_view> json_of_binary(std::span<const std::byte> bytes, const std::string& path) {
  constexpr std::uint32_t kJson = 0x4E4F534A;
  const auto bad = [&path](std::string what) {
    return base::bad_input(std::move(what), path,
                           "the .glb is damaged or cut off; export it again");
  };
  if (bytes.size() < 20) return bad(base::concat("the file ends after ", bytes.size(), " bytes"));
  if (little_endian_32(bytes, 4) != 2) return bad("not version 2 of the binary format");
  const std::uint64_t length = little_endian_32(bytes, 8);
  if (length > bytes.size()) {
    return bad(base::concat("the header promises ", length, " bytes, the file has ", bytes.size()));
  }
  std::optional<std::string_view> json;
  for (std::uint64_t at = 12; at < length;) {
    if (length - at < 8) return bad(base::concat("a chunk header is cut off at byte ", at));
    const std::uint64_t size = little_endian_32(bytes, at);
    if (size > length - at - 8) return bad(base::concat("the chunk at byte ", at, " is cut off"));
    if (at == 12 && little_endian_32(bytes, at + 4) == kJson) {
      json = std::string_view(reinterpret_cast<const char*>(bytes.data()) + at + 8, size);
    }
    at += 8 + size;
  }
  if (!json) return bad("the first chunk is not JSON");
  return *json;
}

Result<void> check_extent(std::string_view json, const std::string& path) {
  const JsonExtent extent = measure_json(json);
  if (extent.depth > kMaxJsonDepth) {
    return base::bad_input(base::concat("the JSON nests ", extent.depth, " levels deep"), path,
                           base::concat("at most ", kMaxJsonDepth));
  }
  if (extent.objects > kMaxJsonObjects || extent.commas > kMaxJsonValues) {
    return base::bad_input(base::concat("the JSON has ", extent.objects, " objects and about ",
                                        extent.commas, " values"),
                           path,
                           base::concat("at most ", kMaxJsonObjects, " objects and ",
                                        kMaxJsonValues, " values; merge nodes and meshes"));
  }
  return {};
}

/// What the parser's callbacks may touch.
struct Reader {
  const SceneFolder& folder;
  std::map<int, Bytes>& inline_images;
  std::optional<Error> refused;  ///< why the first file was not given
};

bool names_an_image(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  constexpr std::array<std::string_view, 8> kSuffixes{".png",  ".jpg",  ".jpeg", ".ktx",
                                                      ".ktx2", ".webp", ".dds",  ".basis"};
  return std::find(kSuffixes.begin(), kSuffixes.end(), suffix) != kSuffixes.end();
}

bool file_exists(const std::string& path, void* user) {
  // Images are read later, and only those that a material uses.
  if (names_an_image(path)) return false;
  Reader& reader = *static_cast<Reader*>(user);
  const auto resolved = reader.folder.resolve(path);
  if (!resolved && !reader.refused) reader.refused = resolved.error();
  return resolved.has_value();
}

std::string same_path(const std::string& path, void*) {
  return path;
}

bool read_whole_file(std::vector<unsigned char>* out, std::string* message, const std::string& path,
                     void* user) {
  const auto resolved = static_cast<Reader*>(user)->folder.resolve(path);
  const Result<Bytes> bytes =
      resolved ? read_file(*resolved, kMaxSceneFileBytes) : forward(resolved);
  if (!bytes) {
    *message = bytes.error().message();
    return false;
  }
  const auto* data = reinterpret_cast<const unsigned char*>(bytes->data());
  out->assign(data, data + bytes->size());
  return true;
}

/// Keeps the encoded bytes of a data URI. Bytes of a buffer view are not looked at: nothing has
/// checked yet that the view lies in its buffer.
bool keep_encoded(tinygltf::Image* image, const int index, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void* user) {
  if (image->bufferView >= 0 || size <= 0) return true;
  const auto* data = reinterpret_cast<const std::byte*>(bytes);
  static_cast<Reader*>(user)->inline_images[index].assign(data, data + size);
  return true;
}

Result<void> parse(std::span<const std::byte> bytes, Document& document) {
  Reader reader{document.folder, document.inline_images, std::nullopt};
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keep_encoded, &reader);
  parser.SetFsCallbacks({file_exists, same_path, read_whole_file, nullptr, &reader});
  const auto size = static_cast<unsigned int>(bytes.size());
  std::string errors, warnings;
  bool parsed = false;
  try {
    parsed =
        is_binary(bytes)
            ? parser.LoadBinaryFromMemory(&document.model, &errors, &warnings,
                                          reinterpret_cast<const unsigned char*>(bytes.data()),
                                          size)
            : parser.LoadASCIIFromString(&document.model, &errors, &warnings,
                                         reinterpret_cast<const char*>(bytes.data()), size, "");
  } catch (const std::exception& exception) {
    errors = exception.what();
  }
  if (parsed) return {};
  if (reader.refused && errors.find("File not found") != std::string::npos) {
    return tl::unexpected(*reader.refused);
  }
  return base::bad_input(one_line(errors), document.path, kValidFile);
}

Result<void> check_version_and_extensions(const Document& document) {
  const std::string& version = document.model.asset.version;
  if (!version.starts_with("2.")) {
    return base::bad_input("asset.version is '" + version + "'", document.path,
                           "only glTF 2.x is read");
  }
  for (const std::string& name : document.model.extensionsRequired) {
    if (std::find(kKnownExtensions.begin(), kKnownExtensions.end(), name) ==
        kKnownExtensions.end()) {
      return base::bad_input("the file requires the extension " + name, document.path,
                             "export without it; known are KHR_materials_emissive_strength, "
                             "KHR_materials_specular, KHR_texture_transform, KHR_lights_punctual");
    }
  }
  return {};
}

}  // namespace

std::string Document::place(std::string_view kind, std::size_t index) const {
  return base::concat(path, ": ", kind, " ", index);
}

Result<Document> read_document(const std::string& path) {
  const Result<Bytes> bytes = read_file(path, kMaxSceneFileBytes);
  if (!bytes) return forward(bytes);
  Result<std::string_view> json =
      std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  if (is_binary(*bytes)) json = json_of_binary(*bytes, path);
  if (!json) return forward(json);
  if (const auto extent = check_extent(*json, path); !extent) return forward(extent);

  Document document{path, SceneFolder(path), {}, {}};
  if (const auto parsed = parse(*bytes, document); !parsed) return forward(parsed);
  if (const auto known = check_version_and_extensions(document); !known) return forward(known);
  return document;
}

}  // namespace macula::scene::gltf
