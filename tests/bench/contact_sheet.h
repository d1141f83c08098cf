// `macula-bench contact-sheet`: a small picture of every scene, side by side with their names, and
// a row of figures for each: its size, what making and building it costs, and how fast rays run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct ContactSheetOptions {
  std::vector<std::string> scenes;  ///< names or files; empty: every built-in scene
  int width_px = 480;               ///< of each picture
  int height_px = 320;
  int columns = 4;
  int samples_per_cell = 16;
  int light_samples = 4;
  int threads = 0;      ///< 0: what the machine offers
  std::string out;      ///< FILE.png
  std::string singles;  ///< folder for the pictures one by one; empty: none
  std::string json;     ///< report; empty: none
};

/// Each scene by its first camera, mode fast. Errors name the scene or file at fault.
Result<void> run_contact_sheet(const ContactSheetOptions& options);

}  // namespace macula::bench
