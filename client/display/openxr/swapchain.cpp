#include "client/display/openxr/swapchain.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "client/display/openxr/xr_values.h"

namespace macula::display {
namespace {

Result<std::int64_t> choose_format(XrSession session, Swapchain::Kind kind) {
  std::uint32_t count = 0;
  xrEnumerateSwapchainFormats(session, 0, &count, nullptr);
  std::vector<std::int64_t> offered(count);
  const XrResult read = xrEnumerateSwapchainFormats(session, count, &count, offered.data());
  if (XR_FAILED(read)) return xr_error(read, "the formats of pictures cannot be read");
  static constexpr std::array kColors{GL_SRGB8_ALPHA8, GL_SRGB8};
  static constexpr std::array kDepths{GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24,
                                      GL_DEPTH_COMPONENT16};
  const auto first_offered = [&](const auto& wanted) -> std::optional<std::int64_t> {
    const auto is_offered = [&](std::int64_t format) {
      return std::find(offered.begin(), offered.end(), format) != offered.end();
    };
    const auto found = std::find_if(wanted.begin(), wanted.end(), is_offered);
    if (found == wanted.end()) return std::nullopt;
    return *found;
  };
  const auto format =
      kind == Swapchain::Kind::Color ? first_offered(kColors) : first_offered(kDepths);
  if (format) return *format;
  return base::runtime_error("the runtime takes no sRGB colour or no depth", "OpenXR",
                             "use another runtime, or --display window");
}

}  // namespace

Result<std::unique_ptr<Swapchain>> Swapchain::create(XrSession session, Kind kind,
                                                     PictureSize size) {
  const auto format = choose_format(session, kind);
  if (!format) return base::forward(format);
  auto info = xr_struct<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
  info.usageFlags = XR_SWAPCHAIN_USAGE_SAMPLED_BIT |
                    (kind == Kind::Color ? XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT
                                         : XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
  info.format = *format;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = static_cast<std::uint32_t>(size.width_px);
  info.height = static_cast<std::uint32_t>(size.height_px);
  XrSwapchain handle = XR_NULL_HANDLE;
  const XrResult made = xrCreateSwapchain(session, &info, &handle);
  if (XR_FAILED(made)) return xr_error(made, "no textures for an eye", "try a smaller --size");
  auto swapchain = std::unique_ptr<Swapchain>(new Swapchain(handle, size));
  if (auto done = swapchain->find_textures(); !done) return base::forward(done);
  return swapchain;
}

Swapchain::~Swapchain() {
  xrDestroySwapchain(swapchain_);
}

Result<void> Swapchain::find_textures() {
  std::uint32_t count = 0;
  xrEnumerateSwapchainImages(swapchain_, 0, &count, nullptr);
  std::vector<XrSwapchainImageOpenGLKHR> images(count,
                                                {XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR, nullptr, 0});
  const XrResult read = xrEnumerateSwapchainImages(
      swapchain_, count, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data()));
  if (XR_FAILED(read)) return xr_error(read, "an eye's textures cannot be read");
  for (const auto& image : images) textures_.push_back(image.image);
  return {};
}

std::optional<unsigned> Swapchain::acquire() {
  std::uint32_t index = 0;
  if (XR_FAILED(xrAcquireSwapchainImage(swapchain_, nullptr, &index))) return std::nullopt;
  const XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr,
                                      std::chrono::nanoseconds(std::chrono::seconds{1}).count()};
  if (xrWaitSwapchainImage(swapchain_, &wait) == XR_SUCCESS) return textures_[index];
  return std::nullopt;
}

void Swapchain::release() {
  xrReleaseSwapchainImage(swapchain_, nullptr);
}

XrSwapchainSubImage Swapchain::whole() const {
  return {swapchain_, {{0, 0}, {size_.width_px, size_.height_px}}, 0};
}

}  // namespace macula::display
