#include "server/filters/filters.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace macula::filters {
namespace {

template <class T>
constexpr int kType = CV_32FC1;
template <>
constexpr int kType<Vec3> = CV_32FC3;
static_assert(sizeof(Vec3) == 3 * sizeof(float));

/// OpenCV keeps threads of its own, which know nothing of the scheduler's stop token.
void stay_on_this_thread() {
  static const bool done = (cv::setNumThreads(1), true);
  static_cast<void>(done);
}

/// Looks at the plane's own pixels, which OpenCV does not write to as a source.
template <class T>
cv::Mat view_of(const Plane<T>& plane) {
  stay_on_this_thread();
  return {plane.height(), plane.width(), kType<T>, const_cast<T*>(plane.data())};
}

/// Makes a plane of `width` x `height` that `fill` writes into.
template <class Fill>
Plane<float> made(int width, int height, const Fill& fill) {
  Plane<float> plane(width, height);
  if (plane.empty()) return plane;
  cv::Mat out = view_of(plane);
  fill(out);
  MACULA_CHECK(out.data == reinterpret_cast<const uchar*>(plane.data()), "filtered in place");
  return plane;
}

template <class T>
Plane<float> length_of_gradient(const Plane<T>& plane) {
  Plane<float> length(plane.width(), plane.height());
  if (plane.empty()) return length;
  cv::Mat dx, dy;
  cv::Sobel(view_of(plane), dx, CV_32F, 1, 0, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  cv::Sobel(view_of(plane), dy, CV_32F, 0, 1, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  constexpr int kChannels = sizeof(T) / sizeof(float);
  for (int y = 0; y < plane.height(); ++y) {
    const auto* x_row = dx.ptr<float>(y);
    const auto* y_row = dy.ptr<float>(y);
    for (int x = 0; x < plane.width(); ++x) {
      float square = 0.0F;
      for (int c = kChannels * x; c < kChannels * (x + 1); ++c) {
        square += x_row[c] * x_row[c] + y_row[c] * y_row[c];
      }
      length(x, y) = std::sqrt(square);
    }
  }
  return length;
}

}  // namespace

Plane<float> sobel_length(const Plane<float>& plane) {
  return length_of_gradient(plane);
}
Plane<float> sobel_length(const Plane<Vec3>& plane) {
  return length_of_gradient(plane);
}

Plane<float> gaussian_mean(const Plane<float>& plane, float sigma_px) {
  MACULA_CHECK(sigma_px > 0.0F);
  return made(plane.width(), plane.height(), [&](cv::Mat& out) {
    cv::GaussianBlur(view_of(plane), out, {5, 5}, static_cast<double>(sigma_px), 0.0,
                     cv::BORDER_REFLECT_101);
  });
}

Plane<float> median_of_25(const Plane<float>& plane) {
  return made(plane.width(), plane.height(),
              [&](cv::Mat& out) { cv::medianBlur(view_of(plane), out, 5); });
}

Plane<float> bilateral_mean(const Plane<float>& plane, float sigma_px, float sigma_value) {
  MACULA_CHECK(sigma_px > 0.0F && sigma_value > 0.0F);
  return made(plane.width(), plane.height(), [&](cv::Mat& out) {
    cv::bilateralFilter(view_of(plane), out, 9, static_cast<double>(sigma_value),
                        static_cast<double>(sigma_px), cv::BORDER_REFLECT_101);
  });
}

LaplacianLevels laplacian_levels(const Plane<float>& plane) {
  if (plane.empty()) return {};
  const cv::Mat full = view_of(plane);
  cv::Mat half, quarter, half_again;
  cv::pyrDown(full, half);
  cv::pyrDown(half, quarter);
  cv::pyrUp(quarter, half_again, half.size());
  LaplacianLevels levels;
  levels.residual = made(plane.width(), plane.height(),
                         [&](cv::Mat& out) { cv::pyrUp(half_again, out, full.size()); });
  levels.finest = made(plane.width(), plane.height(), [&](cv::Mat& out) {
    cv::pyrUp(half, out, full.size());
    cv::subtract(full, out, out);
  });
  return levels;
}

Plane<float> resize_bicubic(const Plane<float>& plane, int width, int height) {
  MACULA_CHECK(!plane.empty() && width > 0 && height > 0);
  return made(width, height, [&](cv::Mat& out) {
    cv::resize(view_of(plane), out, out.size(), 0.0, 0.0, cv::INTER_CUBIC);
  });
}

}  // namespace macula::filters
