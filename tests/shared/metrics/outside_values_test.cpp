// Photographs of rendered scenes and what other people's programs say about them: NVIDIA FLIP v1.6
// (C++ command line), scikit-image 0.19.3 (structural_similarity with gaussian_weights, sigma 1.5,
// use_sample_covariance=False; peak_signal_noise_ratio).
#include <string>

#include <gtest/gtest.h>

#include "shared/image/png.h"
#include "shared/image/tone.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flip.h"
#include "shared/metrics/ssim.h"
#include "tests/support/handed_data.h"

namespace macula::metrics {
namespace {

struct OutsideFlip {
  double mean, median, q1, q3, min, max;
};
struct OutsidePair {
  const char *name, *reference, *test;
  OutsideFlip at_default_ppd, at_20_ppd;
  double mse_8bit, psnr_db, ssim_rgb, ssim_luma;
};

constexpr OutsidePair kPairs[] = {
    {"tree",
     "tree_ref.png",
     "tree_test.png",
     {0.133276, 0.333201, 0.184897, 0.503424, 0.0, 0.983034},
     {0.160173, 0.427789, 0.241185, 0.623871, 0.0, 0.985945},
     384.29813693576386,
     22.284120818432665,
     0.7414866150516861,
     0.7403462655682677},
    {"blur",
     "hall_ref.png",
     "hall_blur2.png",
     {0.104322, 0.174908, 0.083274, 0.293318, 0.001947, 0.623068},
     {0.137544, 0.220259, 0.109847, 0.387206, 0.000301, 0.972891},
     100.04159927368164,
     28.12899735084702,
     0.8517940073904763,
     0.8555316610273187},
    {"jpeg",
     "hall_ref.png",
     "hall_jpeg25.png",
     {0.102838, 0.111187, 0.086554, 0.142402, 0.002255, 0.577762},
     {0.142896, 0.157276, 0.117005, 0.217036, 0.000368, 0.673551},
     33.04183451334635,
     32.94016209117096,
     0.89330289131027,
     0.9213606274113703},
    {"quarter size",
     "hall_ref.png",
     "hall_down4.png",
     {0.086944, 0.142964, 0.068706, 0.267141, 0.001539, 0.824204},
     {0.131189, 0.203865, 0.105016, 0.399, 9e-05, 0.969357},
     135.9103978474935,
     26.798276770931242,
     0.8186868393874773,
     0.8202655886368545},
    {"noise",
     "hall_ref.png",
     "hall_noise12.png",
     {0.108377, 0.119123, 0.092927, 0.150048, 0.002508, 0.424777},
     {0.274559, 0.303128, 0.236516, 0.380456, 0.003812, 0.798315},
     142.10313034057617,
     26.604767159125394,
     0.49194356947386025,
     0.6560877252668427},
    {"foveated",
     "hall_ref.png",
     "hall_foveated.png",
     {0.10451, 0.208809, 0.096335, 0.367433, 0.0, 0.925968},
     {0.128662, 0.232562, 0.11506, 0.412425, 0.0, 0.973839},
     111.32751719156902,
     27.66477837257336,
     0.8584058794762982,
     0.8620492586458096},
    {"identity",
     "hall_ref.png",
     "hall_ref.png",
     {0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
     {0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
     0.0,
     kBestDb,
     1.0,
     1.0},
};

Plane<Rgb8> load(const char* name) {
  const auto picture = image::read_png((test::handed_data() / "metrics" / name).string());
  EXPECT_TRUE(picture) << picture.error().message();
  return picture.value_or(Plane<Rgb8>{});
}

void expect_flip(const OutsideFlip& expected, const ErrorSummary& ours) {
  constexpr double kMeanTolerance = 2e-5, kQuantileTolerance = 1e-3;
  EXPECT_NEAR(ours.mean, expected.mean, kMeanTolerance);
  EXPECT_NEAR(ours.weighted_median, expected.median, kQuantileTolerance);
  EXPECT_NEAR(ours.weighted_q1, expected.q1, kQuantileTolerance);
  EXPECT_NEAR(ours.weighted_q3, expected.q3, kQuantileTolerance);
  EXPECT_NEAR(ours.min, expected.min, kQuantileTolerance);
  EXPECT_NEAR(ours.max, expected.max, kQuantileTolerance);
}

class OutsideValues : public testing::TestWithParam<OutsidePair> {};

TEST_P(OutsideValues, OfFlipAreOurs) {
  MACULA_NEEDS_HANDED_DATA("metrics");
  const Plane<Rgb> reference = image::decode_display_linear(load(GetParam().reference));
  const Plane<Rgb> test = image::decode_display_linear(load(GetParam().test));
  expect_flip(GetParam().at_default_ppd, summarise(flip_map(reference, test)));
  expect_flip(GetParam().at_20_ppd, summarise(flip_map(reference, test, 20.0)));
}

TEST_P(OutsideValues, OfPsnrAndSsimAreOurs) {
  MACULA_NEEDS_HANDED_DATA("metrics");
  const Plane<Rgb> reference = unit_from_8bit(load(GetParam().reference));
  const Plane<Rgb> test = unit_from_8bit(load(GetParam().test));
  EXPECT_NEAR(255.0 * 255.0 * mse(reference, test), GetParam().mse_8bit, 1e-3);
  EXPECT_NEAR(psnr_db(reference, test), GetParam().psnr_db, 1e-4);
  EXPECT_NEAR(ssim_rgb(reference, test), GetParam().ssim_rgb, 1e-5);
  EXPECT_NEAR(ssim_luma(reference, test), GetParam().ssim_luma, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Pairs, OutsideValues, testing::ValuesIn(kPairs), [](const auto& pair) {
  std::string name = pair.param.name;
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
});

}  // namespace
}  // namespace macula::metrics
