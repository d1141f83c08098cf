#include "server/scene/assimp/parcel.h"

#include <cstring>
#include <span>
#include <type_traits>

namespace macula::scene::assimp {
namespace {

constexpr std::uint32_t kParcel = 0x4D50434CU, kError = 0x4D504552U;  ///< first word

/// One description of every type, `each(archive, value)`, serves both directions.
class Writer {
 public:
  template <class T>
  void plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof value);
  }
  template <class T>
  void array(const std::vector<T>& values) {
    plain(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size() * sizeof(T));
  }
  void text(const std::string& value) {
    plain(static_cast<std::uint64_t>(value.size()));
    append(value.data(), value.size());
  }
  template <class T>
  void list(const std::vector<T>& values) {
    plain(static_cast<std::uint64_t>(values.size()));
    for (const T& value : values) each(*this, value);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t size) {
    const auto* from = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }
  Bytes bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  void plain(T& value) {
    take(&value, sizeof value);
  }
  template <class T>
  void array(std::vector<T>& values) {
    values.resize(count(sizeof(T)));
    take(values.data(), values.size() * sizeof(T));
  }
  void text(std::string& value) {
    value.resize(count(1));
    take(value.data(), value.size());
  }
  template <class T>
  void list(std::vector<T>& values) {
    values.resize(count(sizeof(std::uint64_t)));
    for (T& value : values) each(*this, value);
  }
  /// Whether every byte was read and none was missing.
  bool sound() const { return !short_ && rest_.empty(); }

 private:
  /// Of elements that take at least `least` bytes each: never more than there are bytes left.
  std::size_t count(std::size_t least) {
    std::uint64_t value = 0;
    plain(value);
    if (value <= rest_.size() / least) return static_cast<std::size_t>(value);
    short_ = true;
    rest_ = {};
    return 0;
  }
  void take(void* to, std::size_t size) {
    if (size == 0) return;
    if (size > rest_.size()) {
      short_ = true;
      rest_ = {};
      std::memset(to, 0, size);
      return;
    }
    std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  std::span<const std::byte> rest_;
  bool short_ = false;
};

template <class Archive, class Text>
requires std::is_same_v<std::remove_const_t<Text>, std::string>
void each(Archive& archive, Text& value) {
  archive.text(value);
}

template <class Archive, class Texture>
void texture(Archive& archive, Texture& value) {
  archive.text(value.path);
  archive.plain(value.wrap_u);
  archive.plain(value.wrap_v);
}

template <class Archive, class Value>
requires std::is_same_v<std::remove_const_t<Value>, ParcelMaterial>
void each(Archive& archive, Value& value) {
  archive.text(value.name);
  archive.plain(value.numbers);
  texture(archive, value.base_color);
  texture(archive, value.alpha);
  texture(archive, value.emission);
}

template <class Archive, class Value>
requires std::is_same_v<std::remove_const_t<Value>, ParcelMesh>
void each(Archive& archive, Value& value) {
  archive.text(value.name);
  archive.plain(value.material);
  archive.array(value.positions);
  archive.array(value.normals);
  archive.array(value.texcoords);
  archive.array(value.triangles);
}

template <class Archive, class Value>
requires std::is_same_v<std::remove_const_t<Value>, ParcelCamera>
void each(Archive& archive, Value& value) {
  archive.text(value.name);
  archive.plain(value.position);
  archive.plain(value.direction);
  archive.plain(value.up);
  archive.plain(value.vertical_fov_rad);
}

template <class Archive, class Value>
void whole(Archive& archive, Value& parcel) {
  archive.list(parcel.materials);
  archive.list(parcel.meshes);
  archive.array(parcel.instances);
  archive.array(parcel.lights);
  archive.list(parcel.cameras);
  archive.list(parcel.warnings);
  archive.plain(parcel.meters_per_unit);
}

}  // namespace

Bytes encode(const Result<Parcel>& parcel) {
  Writer writer;
  writer.plain(parcel ? kParcel : kError);
  if (parcel) {
    whole(writer, *parcel);
  } else {
    writer.text(parcel.error().what);
    writer.text(parcel.error().where);
    writer.text(parcel.error().remedy);
  }
  return writer.take();
}

Result<Parcel> decode(const Bytes& bytes, const std::string& place) {
  Reader reader(bytes);
  std::uint32_t kind = 0;
  reader.plain(kind);
  Parcel parcel;
  Error error;
  if (kind == kParcel) whole(reader, parcel);
  if (kind == kError) {
    reader.text(error.what);
    reader.text(error.where);
    reader.text(error.remedy);
  }
  if (reader.sound() && kind == kParcel) return parcel;
  if (reader.sound() && kind == kError) return tl::unexpected(error);
  return base::bad_input("the importer broke down on this file", place,
                         "the file is damaged; export it again, best as glTF");
}

}  // namespace macula::scene::assimp
