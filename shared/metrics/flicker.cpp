#include "shared/metrics/flicker.h"

#include <algorithm>
#include <cmath>

#include "shared/metrics/pyramid.h"

namespace macula::metrics {

void TemporalDeviation::add(const Plane<float>& values) {
  if (count_ == 0) {
    mean_.resize(values.width(), values.height(), 0.0);
    squares_.resize(values.width(), values.height(), 0.0);
  }
  MACULA_CHECK(values.rect() == mean_.rect(), "a frame changed size");
  ++count_;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double before = values.data()[i] - mean_.data()[i];
    mean_.data()[i] += before / count_;
    squares_.data()[i] += before * (values.data()[i] - mean_.data()[i]);
  }
}

double TemporalDeviation::mean_variance() const {
  if (count_ == 0 || squares_.empty()) return 0.0;
  double sum = 0.0;
  for (const double value : squares_.pixels()) sum += value;
  return sum / (static_cast<double>(squares_.size()) * count_);
}

FlickerMeter::FlickerMeter(int bands) : bands_(bands) {
  MACULA_CHECK(bands >= 0, "bands");
  per_band_.resize(static_cast<std::size_t>(bands) + 1);
}

void FlickerMeter::add(const Plane<float>& reference, const Plane<float>& test) {
  MACULA_CHECK(reference.rect() == test.rect(), "pictures differ in size");
  Plane<float> difference(test.width(), test.height());
  std::ranges::transform(test.pixels(), reference.pixels(), difference.pixels().begin(),
                         [](float t, float r) { return t - r; });
  whole_.add(difference);
  const std::vector<Plane<float>> pyramid = laplacian_pyramid(difference, bands_);
  for (std::size_t b = 0; b < pyramid.size(); ++b) per_band_[b].add(pyramid[b]);
}

double FlickerMeter::rms() const {
  return std::sqrt(whole_.mean_variance());
}

std::vector<double> FlickerMeter::rms_per_band() const {
  std::vector<double> result;
  for (const TemporalDeviation& band : per_band_) result.push_back(std::sqrt(band.mean_variance()));
  return result;
}

double warped_flicker_rms(const WarpedStep& step, const Plane<unsigned char>& visible_before) {
  MACULA_CHECK(step.test.rect() == visible_before.rect() &&
                   step.warped_last_test.rect() == visible_before.rect() &&
                   step.reference.rect() == visible_before.rect() &&
                   step.warped_last_reference.rect() == visible_before.rect(),
               "planes differ in size");
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < visible_before.size(); ++i) {
    if (visible_before.data()[i] == 0) continue;
    const double test_change = step.test.data()[i] - step.warped_last_test.data()[i];
    const double reference_change = step.reference.data()[i] - step.warped_last_reference.data()[i];
    sum += (test_change - reference_change) * (test_change - reference_change);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace macula::metrics
