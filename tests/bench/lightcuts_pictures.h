// What `macula-bench lightcuts --pictures` leaves to be looked at, of one scene and gaze: a
// picture, an error map and a map of samples of every method, and four labelled sheets after the
// paper's figures, with a ring at 25 degrees: maps.png (6: samples of every mode at equal means),
// errors.png (5: methods beside the baselines that took about their time), alphas.png (7) and
// stages.png (what the stages of a frame make).
#pragma once

#include <string>
#include <vector>

#include "tests/bench/figure_sheet.h"
#include "tests/bench/lightcuts_setting.h"

namespace macula::bench {

/// What a method's figures are, means over its frames.
struct ShownFigures {
  std::string name;      ///< of the method
  std::string label;     ///< unlike all others'
  std::string baseline;  ///< whose curve it is held against; its own name: a point of that
  float alpha = 0.0F;
  double cpu_ms = 0.0;
  Regional mse, lspp;
};

class LightcutsPictures {
 public:
  /// `folder` is made. `suffix`: of every file's name, before the dot.
  LightcutsPictures(std::string folder, std::string suffix, std::string title,
                    const LightcutsSetting& setting, const LightcutsJudge& judge,
                    scheduling::TileScheduler& scheduler);

  /// Writes what one method showed, and keeps it for the sheets.
  void add(const ShownFigures& figures, const kernels::lightcuts::Config& config,
           const Plane<Rgb>& radiance);
  void write_sheets() const;

 private:
  struct Shown {
    ShownFigures figures;
    Plane<Rgb8> picture, map;  ///< map: empty where cuts are of equal size
    Plane<float> squares;      ///< of errors
  };

  void write_maps() const;
  void write_errors() const;
  void write_alphas() const;
  void write_stages() const;

  const Shown* find(const std::string& name, float alpha) const;
  const Shown* nearest_in_time(const std::string& baseline, double cpu_ms) const;
  std::vector<const Shown*> compared() const;
  static ColorScale error_scale(const std::vector<const Shown*>& all);

  Plane<Rgb8> ringed(Plane<Rgb8> picture) const;
  Plane<Rgb8> shown(const Plane<Rgb>& radiance) const;
  void write(const std::string& name, const Plane<Rgb8>& picture) const;

  std::string folder_, suffix_, title_;
  const LightcutsSetting& setting_;
  const LightcutsJudge& judge_;
  scheduling::TileScheduler& scheduler_;
  Plane<std::uint8_t> within_f25_;
  std::vector<Shown> all_;
};

}  // namespace macula::bench
