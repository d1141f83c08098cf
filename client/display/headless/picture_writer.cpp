#include "client/display/headless/picture_writer.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "shared/base/check.h"
#include "shared/image/draw.h"
#include "shared/image/png.h"

namespace macula::display {
namespace {

constexpr std::size_t kMostWaiting = 8;
constexpr std::array<const char*, 2> kEyeNames = {"left", "right"};

std::string eye_name(std::size_t eye) {
  return eye < kEyeNames.size() ? kEyeNames[eye] : std::to_string(eye);
}

std::string frame_name(std::uint64_t shown, std::size_t eye) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%06llu", static_cast<unsigned long long>(shown));
  return std::string("frames/") + digits.data() + "_" + eye_name(eye) + ".png";
}

}  // namespace

Result<std::unique_ptr<PictureWriter>> PictureWriter::create(const PictureOptions& options) {
  MACULA_CHECK(options.every >= 1 && options.sheet_tiles >= 1 && options.sheet_tile_px >= 1);
  std::error_code code;
  std::filesystem::create_directories(std::filesystem::path(options.folder) / "frames", code);
  if (code) {
    return base::bad_input("the folder cannot be made: " + code.message(), options.folder,
                           "choose another with --out");
  }
  return std::unique_ptr<PictureWriter>(new PictureWriter(options));
}

PictureWriter::PictureWriter(const PictureOptions& options)
    : options_(options), jobs_(kMostWaiting), thread_([this] { work(); }) {}

PictureWriter::~PictureWriter() {
  jobs_.close();
  if (thread_.joinable()) thread_.join();
}

void PictureWriter::show(std::uint64_t shown, const EyePictures& eyes) {
  if (shown % static_cast<std::uint64_t>(options_.every) != 0) return;
  if (!jobs_.put({shown, eyes})) ++skipped_;
}

void PictureWriter::work() {
  constexpr Nanoseconds kPatience = std::chrono::seconds{1};
  while (true) {
    if (auto job = jobs_.wait(kPatience)) {
      write(*job);
    } else if (jobs_.closed()) {
      return;
    }
  }
}

void PictureWriter::write(const Job& job) {
  EyePictures small;
  for (std::size_t eye = 0; eye < job.eyes.size(); ++eye) {
    write(frame_name(job.shown, eye), job.eyes[eye]);
    small.push_back(image::downscale(job.eyes[eye], options_.sheet_tile_px));
  }
  thumbnails_.push_back(std::move(small));
}

void PictureWriter::write(const std::string& name, const image::Plane<Rgb8>& picture) {
  const auto path = std::filesystem::path(options_.folder) / name;
  if (auto done = image::write_png(path.string(), picture); done) {
    ++written_;
  } else if (first_error_) {
    first_error_ = std::move(done);
  }
}

/// Evenly spread over the run, a frame's eyes side by side, three frames a row.
image::Plane<Rgb8> PictureWriter::make_sheet() const {
  const auto tiles = std::min(thumbnails_.size(), static_cast<std::size_t>(options_.sheet_tiles));
  std::vector<image::Plane<Rgb8>> pictures;
  for (std::size_t i = 0; i < tiles; ++i) {
    for (const auto& eye : thumbnails_[i * thumbnails_.size() / tiles]) pictures.push_back(eye);
  }
  constexpr int kFramesPerRow = 3;
  const int eyes = static_cast<int>(thumbnails_.front().size());
  return image::contact_sheet(pictures, kFramesPerRow * eyes, options_.sheet_tile_px);
}

Result<void> PictureWriter::finish(const EyePictures& last, const EyePictures& rate_maps) {
  jobs_.close();
  if (thread_.joinable()) thread_.join();
  for (std::size_t eye = 0; eye < last.size(); ++eye)
    write("eye_" + eye_name(eye) + ".png", last[eye]);
  if (!thumbnails_.empty()) write("contact_sheet.png", make_sheet());
  if (!rate_maps.empty()) {
    write("rate_map.png", image::contact_sheet(rate_maps, static_cast<int>(rate_maps.size()),
                                               rate_maps.front().width()));
  }
  return first_error_;
}

}  // namespace macula::display
