#include "server/exr/exr.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfTestFile.h>

namespace macula::exr {
namespace {

using base::bad_input;
using base::forward;

/// OpenEXR's own guard, which also holds for tables it allocates while it parses the header.
constexpr int kLargestSide_px = 65536;
void limit_sizes() {
  static const bool done = [] {
    Imf::Header::setMaxImageSize(kLargestSide_px, kLargestSide_px);
    Imf::Header::setMaxTileSize(4096, 4096);
    return true;
  }();
  static_cast<void>(done);
}

Result<void> check_is_exr(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return bad_input("no such file", path, "give the path of an OpenEXR picture");
  }
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return bad_input("not a file", path, "give the path of an OpenEXR picture");
  }
  if (!Imf::isOpenExrFile(path.c_str())) {
    return bad_input("not an OpenEXR file, or it cannot be read", path,
                     "the first bytes should be 76 2f 31 01");
  }
  return {};
}

/// Rows without gaps that cover `window`, `pixel_bytes` between neighbours.
Imf::Slice slice(const float* first, const Imath::Box2i& window, std::size_t pixel_bytes) {
  // OpenEXR takes a non-const pointer for writing and reading alike.
  auto* bytes = reinterpret_cast<char*>(const_cast<float*>(first));
  return Imf::Slice::Make(Imf::FLOAT, bytes, window, pixel_bytes);
}

struct Size {
  int width, height;
};
Result<Size> checked_size(const Imath::Box2i& window, const std::string& path, int max_side_px) {
  const long long width = 1LL + window.max.x - window.min.x;
  const long long height = 1LL + window.max.y - window.min.y;
  if (width < 1 || height < 1 || width > max_side_px || height > max_side_px) {
    return bad_input(
        "the picture is " + std::to_string(width) + "x" + std::to_string(height) + " px", path,
        "allowed: 1.." + std::to_string(max_side_px) + " px a side");
  }
  return Size{static_cast<int>(width), static_cast<int>(height)};
}

/// The three channels to read, or Y three times.
Result<std::vector<std::string>> color_channels(const Imf::ChannelList& channels,
                                                const std::string& path) {
  std::vector<std::string> wanted = {"R", "G", "B"};
  const bool has_rgb = channels.findChannel("R") != nullptr &&
                       channels.findChannel("G") != nullptr && channels.findChannel("B") != nullptr;
  if (!has_rgb) wanted = {"Y"};
  std::string found;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    found += std::string(found.empty() ? "" : " ") + c.name();
  }
  const bool has_chroma =
      channels.findChannel("RY") != nullptr || channels.findChannel("BY") != nullptr;
  for (const std::string& name : wanted) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (channel == nullptr || (!has_rgb && has_chroma)) {
      return bad_input("has no colour among its channels '" + found + "'", path,
                       "needed: R, G and B, or Y alone");
    }
    if (channel->xSampling != 1 || channel->ySampling != 1) {
      return bad_input("channel " + name + " is sub-sampled", path, "save it at full resolution");
    }
  }
  return wanted;
}

Result<Plane<Rgb>> read_pixels(Imf::InputFile& file, const std::string& path, int max_side_px) {
  const Imath::Box2i window = file.header().dataWindow();
  const auto size = checked_size(window, path, max_side_px);
  if (!size) return forward(size);
  const auto channels = color_channels(file.header().channels(), path);
  if (!channels) return forward(channels);

  Plane<Rgb> picture(size->width, size->height);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels->size(); ++c) {
    const float* first = &picture.data()->x + c;
    buffer.insert((*channels)[c], slice(first, window, sizeof(Rgb)));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  if (channels->size() == 1) {
    for (Rgb& color : picture.pixels()) color = Rgb{color.x};
  }
  return picture;
}

/// A channel to write: `stride_bytes` between pixels, rows without gaps.
struct Channel {
  std::string name;
  const float* first = nullptr;
  std::size_t stride_bytes = sizeof(float);
};

std::string encoded(Size size, const std::vector<Channel>& channels) {
  Imf::Header header(size.width, size.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::addChromaticities(header, Imf::Chromaticities{});  // the default is Rec.709 with D65
  Imf::FrameBuffer buffer;
  for (const Channel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    buffer.insert(channel.name, slice(channel.first, header.dataWindow(), channel.stride_bytes));
  }
  Imf::StdOSStream stream;  // in memory: a full disk is then seen by us, not by a destructor
  {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(size.height);
  }
  return stream.str();
}

Result<void> write_file(const std::string& path, const std::string& bytes) {
  errno = 0;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) {
    return bad_input(std::string("cannot be written: ") + std::strerror(errno), path,
                     "give a path in a folder that exists and has room");
  }
  return {};
}

Result<void> write_channels(const std::string& path, Size size,
                            const std::vector<Channel>& channels) {
  MACULA_CHECK(size.width > 0 && size.height > 0, "an OpenEXR picture has pixels");
  try {
    return write_file(path, encoded(size, channels));
  } catch (const std::exception& error) {
    return base::runtime_error(std::string("OpenEXR: ") + error.what(), path);
  }
}

}  // namespace

Result<Plane<Rgb>> read(const std::string& path, int max_side_px) {
  limit_sizes();
  if (const auto fine = check_is_exr(path); !fine) return forward(fine);
  try {
    Imf::InputFile file(path.c_str(), 0);
    return read_pixels(file, path, max_side_px);
  } catch (const std::exception& error) {
    return bad_input(std::string("broken OpenEXR file: ") + error.what(), path,
                     "write it again or fetch it again");
  }
}

Result<void> write(const std::string& path, const Plane<Rgb>& radiance) {
  const float* first = &radiance.data()->x;
  return write_channels(
      path, {radiance.width(), radiance.height()},
      {{"R", first, sizeof(Rgb)}, {"G", first + 1, sizeof(Rgb)}, {"B", first + 2, sizeof(Rgb)}});
}

Result<void> write_layers(const std::string& path, std::span<const NamedPlane> planes) {
  MACULA_CHECK(!planes.empty(), "at least one plane");
  std::vector<Channel> channels;
  for (const NamedPlane& plane : planes) {
    MACULA_CHECK(plane.values != nullptr && plane.values->rect() == planes[0].values->rect(),
                 "planes differ in size: " + plane.name);
    for (const Channel& other : channels) {
      MACULA_CHECK(other.name != plane.name, "two planes named " + plane.name);
    }
    channels.push_back({plane.name, plane.values->data()});
  }
  return write_channels(path, {planes[0].values->width(), planes[0].values->height()}, channels);
}

}  // namespace macula::exr
