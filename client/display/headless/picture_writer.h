// PictureWriter: PNG files of what was shown, written by a thread of its own so that the display
// loop's pace does not depend on the disk. When the disk cannot keep up pictures are skipped and
// counted, never waited for. Files in the folder: frames/NNNNNN_left.png and _right.png for every
// Nth shown frame, eye_left.png and eye_right.png of the last, contact_sheet.png, rate_map.png.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "shared/base/mailbox.h"
#include "shared/base/result.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/units/time.h"

namespace macula::display {

using EyePictures = std::vector<image::Plane<Rgb8>>;  ///< left first

struct PictureOptions {
  std::string folder;
  int every = 12;           ///< of the shown frames, 1 or more
  int sheet_tiles = 12;     ///< shown frames on the contact sheet
  int sheet_tile_px = 240;  ///< width of one eye there
};

class PictureWriter {
 public:
  /// Makes the folder. Errors name it and what the system says.
  static Result<std::unique_ptr<PictureWriter>> create(const PictureOptions& options);
  ~PictureWriter();

  /// Takes every Nth shown frame; copies it only then.
  void show(std::uint64_t shown, const EyePictures& eyes);
  /// Writes what is left: the last frame's eyes, the sheet, the maps (one an eye, side by side).
  /// Returns the first error of the whole run. Once, after the last show().
  Result<void> finish(const EyePictures& last, const EyePictures& rate_maps);

  std::uint64_t written() const { return written_; }
  std::uint64_t skipped() const { return skipped_; }

 private:
  struct Job {
    std::uint64_t shown = 0;
    EyePictures eyes;
  };
  explicit PictureWriter(const PictureOptions& options);
  void work();
  void write(const Job& job);
  void write(const std::string& name, const image::Plane<Rgb8>& picture);
  image::Plane<Rgb8> make_sheet() const;

  const PictureOptions options_;
  base::Channel<Job> jobs_;
  std::atomic<std::uint64_t> written_{0}, skipped_{0};
  std::vector<EyePictures> thumbnails_;  // the writing thread's, until it is joined
  Result<void> first_error_;
  std::thread thread_;
};

}  // namespace macula::display
