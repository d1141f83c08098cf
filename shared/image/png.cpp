#include "shared/image/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "shared/base/text.h"

namespace macula::image {
namespace {

using base::bad_input;
using base::concat;
using base::runtime_error;
using Bytes = std::vector<std::byte>;

/// What libpng said before it jumped back.
struct Complaint {
  std::array<char, 160> text{};
};

void on_error(png_structp png, png_const_charp message) {
  auto& complaint = *static_cast<Complaint*>(png_get_error_ptr(png));
  std::snprintf(complaint.text.data(), complaint.text.size(), "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// Runs `step`, whose calls into libpng come back here by longjmp when they fail. A step must
/// therefore own nothing that has a destructor. False after a failure.
template <class Step>
bool guarded(png_structp png, const Step& step) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  step();
  return true;
}

// ---------------------------------------------------------------------------------------- reading

struct Input {
  std::span<const std::byte> rest;
};

void read_from_memory(png_structp png, png_bytep out, png_size_t count) {
  auto& input = *static_cast<Input*>(png_get_io_ptr(png));
  if (count > input.rest.size()) png_error(png, "the file ends too early");
  std::memcpy(out, input.rest.data(), count);
  input.rest = input.rest.subspan(count);
}

enum class Channels { Rgb, Rgba };

/// One decoding; owns libpng's two objects. Not copied, not moved: libpng keeps pointers into it.
class Decoder {
 public:
  Decoder(std::span<const std::byte> bytes, const std::string& name) : name_(name), input_{bytes} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint_, on_error, on_warning);
    MACULA_CHECK(png_ != nullptr, "libpng has no memory for a reader");
    info_ = png_create_info_struct(png_);
    MACULA_CHECK(info_ != nullptr, "libpng has no memory for a header");
  }
  ~Decoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  template <class T>
  Result<Plane<T>> decode(Channels channels, int max_side_px) {
    static_assert(sizeof(T) == 3 || sizeof(T) == 4);
    const std::size_t available = input_.rest.size();
    if (!read_header()) return failure();
    if (auto ok = check_size(max_side_px, available); !ok) return base::forward(ok);
    if (!ask_for_eight_bits(channels)) return failure();
    if (png_get_rowbytes(png_, info_) != sizeof(T) * static_cast<std::size_t>(width()))
      return bad_input("its pixels do not convert to 8 bits a channel", name_);
    Plane<T> picture(width(), height());
    std::vector<png_bytep> rows(static_cast<std::size_t>(height()));
    for (int y = 0; y < height(); ++y)
      rows[static_cast<std::size_t>(y)] = reinterpret_cast<png_bytep>(picture.row(y).data());
    if (!read_rows(rows)) return failure();
    return picture;
  }

 private:
  int width() const { return static_cast<int>(png_get_image_width(png_, info_)); }
  int height() const { return static_cast<int>(png_get_image_height(png_, info_)); }

  bool read_header() {
    return guarded(png_, [this] {
      png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_size says it better
      png_set_chunk_malloc_max(png_, png_alloc_size_t{16} << 20);
      png_set_read_fn(png_, &input_, read_from_memory);
      png_read_info(png_, info_);
    });
  }

  /// Both the limit asked for and what the file can possibly hold: deflate never shrinks by more
  /// than 1032 to 1, so a small file that claims a huge picture is refused before allocating it.
  Result<void> check_size(int max_side_px, std::size_t available) const {
    constexpr std::size_t kDeflateBestRatio = 1032;
    if (width() > max_side_px || height() > max_side_px)
      return bad_input(concat("the picture is ", width(), " x ", height(), " px"), name_,
                       concat("at most ", max_side_px, " px a side"));
    const std::size_t raw = png_get_rowbytes(png_, info_) * static_cast<std::size_t>(height());
    if (raw / kDeflateBestRatio > available)
      return bad_input(concat("the file of ", available, " bytes cannot hold its ", width(), " x ",
                              height(), " px"),
                       name_);
    return {};
  }

  bool ask_for_eight_bits(Channels channels) {
    return guarded(png_, [this, channels] {
      png_set_expand(png_);  // palette, 1/2/4-bit grey and tRNS become plain 8-bit channels
      png_set_scale_16(png_);
      png_set_gray_to_rgb(png_);
      if (channels == Channels::Rgb)
        png_set_strip_alpha(png_);
      else
        png_set_add_alpha(png_, 0xFF, PNG_FILLER_AFTER);
      png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
    });
  }

  bool read_rows(std::vector<png_bytep>& rows) {
    return guarded(png_, [this, &rows] {
      png_read_image(png_, rows.data());
      png_read_end(png_, nullptr);
    });
  }

  tl::unexpected<Error> failure() const {
    return bad_input(concat("not a readable PNG: ", complaint_.text.data()), name_,
                     "8 or 16 bit grey, palette or RGB, with or without alpha");
  }

  const std::string& name_;
  Input input_;
  Complaint complaint_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

Result<Bytes> read_file(const std::string& path) {
  constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 31;
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed) return bad_input(failed.message(), path, "a PNG file that exists");
  if (size > kLargestFile) return bad_input("larger than 2 GiB", path);
  std::ifstream file(path, std::ios::binary);
  if (!file) return bad_input(std::strerror(errno), path, "a readable PNG file");
  Bytes bytes(static_cast<std::size_t>(size));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(file.gcount()));  // it may have shrunk meanwhile
  return bytes;
}

// ---------------------------------------------------------------------------------------- writing

void write_to_memory(png_structp png, png_bytep data, png_size_t count) {
  auto& out = *static_cast<Bytes*>(png_get_io_ptr(png));
  const auto* first = reinterpret_cast<const std::byte*>(data);
  out.insert(out.end(), first, first + count);
}

void flush_nothing(png_structp) {}

/// One encoding of a picture with at least one pixel.
class Encoder {
 public:
  Encoder() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, &complaint_, on_error, on_warning);
    MACULA_CHECK(png_ != nullptr, "libpng has no memory for a writer");
    info_ = png_create_info_struct(png_);
    MACULA_CHECK(info_ != nullptr, "libpng has no memory for a header");
  }
  ~Encoder() { png_destroy_write_struct(&png_, &info_); }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  Result<Bytes> encode(const Plane<Rgb8>& picture, const std::string& name) {
    Bytes out;
    out.reserve(picture.size());
    if (!write_all(picture, out)) return runtime_error(complaint_.text.data(), name);
    return out;
  }

 private:
  /// Fast rather than small: level 2 with the Up filter, because pictures are written while a
  /// client is running.
  bool write_all(const Plane<Rgb8>& picture, Bytes& out) {
    return guarded(png_, [this, &picture, &out] {
      png_set_write_fn(png_, &out, write_to_memory, flush_nothing);
      png_set_IHDR(png_, info_, static_cast<png_uint_32>(picture.width()),
                   static_cast<png_uint_32>(picture.height()), 8, PNG_COLOR_TYPE_RGB,
                   PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
      png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
      png_set_compression_level(png_, 2);
      png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
      png_write_info(png_, info_);
      for (int y = 0; y < picture.height(); ++y)
        png_write_row(png_, reinterpret_cast<png_const_bytep>(picture.row(y).data()));
      png_write_end(png_, nullptr);
    });
  }

  Complaint complaint_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

Result<void> write_png(const std::string& path, const Plane<Rgb8>& picture) {
  if (picture.empty()) return bad_input("a PNG has no room for a picture without pixels", path);
  const auto bytes = Encoder{}.encode(picture, path);
  if (!bytes) return base::forward(bytes);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) return runtime_error(std::strerror(errno), path, "a path that can be written");
  file.write(reinterpret_cast<const char*>(bytes->data()),
             static_cast<std::streamsize>(bytes->size()));
  file.close();
  if (!file) return runtime_error("the picture was not written in full", path, "is the disk full?");
  return {};
}

Result<Plane<Rgb8>> read_png(const std::string& path, int max_side_px) {
  const auto bytes = read_file(path);
  if (!bytes) return base::forward(bytes);
  return Decoder{*bytes, path}.decode<Rgb8>(Channels::Rgb, max_side_px);
}

Result<Plane<Rgba8>> decode_png(std::span<const std::byte> bytes, const std::string& name,
                                int max_side_px) {
  return Decoder{bytes, name}.decode<Rgba8>(Channels::Rgba, max_side_px);
}

}  // namespace macula::image
