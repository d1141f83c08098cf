// Screen: where warped pictures go, when, and what comes back from there. Refreshes go next,
// then show or skip, one at a time. One thread.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "client/app/client_config.h"
#include "client/app/comparison.h"
#include "client/app/refresh_clock.h"
#include "client/app/run_log.h"
#include "client/app/warp_stage.h"
#include "client/display/headless/report.h"
#include "client/pose/pose_source.h"
#include "shared/base/clock.h"
#include "shared/base/result.h"

namespace macula::client_app {

class Screen {
 public:
  virtual ~Screen() = default;
  /// Before each refresh: takes the news of person and device. The reason to end, if it has one.
  virtual std::optional<display::RunEnd> poll() = 0;
  /// As soon as it begins; nullopt: nobody would see one now, poll again.
  virtual std::optional<Refresh> next_refresh() = 0;
  /// The eyes at the refresh's display time.
  virtual const EyeRig& rig() const = 0;
  /// The two ways (Comparison::ways) that the person wants compared; nullopt: none.
  virtual std::optional<std::array<int, 2>> compared_ways() const { return std::nullopt; }
  /// The next show() shows these instead; null: its own pictures again. Outlives the show.
  virtual void compare(Comparison* /*comparison*/) {}
  /// Shows one refresh and where the head's gaze is. Returns when its light is seen.
  virtual ClientTime show(const Refresh& refresh, const WarpedEyes& eyes,
                          const Gaze& head_gaze) = 0;
  /// After `log` has noted what was shown; for a screen that tells of it.
  virtual void note(const Showing& /*showing*/, const RunLog& /*log*/,
                    const net::ClientEndpoint& /*endpoint*/) {}
  /// Ends a refresh for which there is no picture.
  virtual void skip(const Refresh& refresh) = 0;
  virtual double refresh_hz() const = 0;
  /// Refreshes that were over before they could begin.
  virtual std::uint64_t missed_refreshes() const = 0;
  /// What drives the head when no trace does; it must not outlive the screen.
  virtual std::unique_ptr<pose::PoseSource> viewer() = 0;
};

/// A screen that the clock paces and whose eyes the config describes.
class ClockedScreen : public Screen {
 public:
  /// Time begins with the first refresh.
  ClockedScreen(const ClientConfig& config, const base::Clock& clock);

  std::optional<Refresh> next_refresh() final;
  const EyeRig& rig() const final { return rig_; }
  ClientTime show(const Refresh& refresh, const WarpedEyes& eyes, const Gaze& head_gaze) final;
  void skip(const Refresh& refresh) final;
  double refresh_hz() const final { return refresh_hz_; }
  std::uint64_t missed_refreshes() const final;

 protected:
  virtual void present(const display::EyePictures& eyes, const Gaze& head_gaze) = 0;

 private:
  const double refresh_hz_;
  const Pacing pacing_;
  const base::Clock& clock_;
  const EyeRig rig_;
  std::optional<RefreshClock> refreshes_;
};

/// Errors: the window cannot be opened, no headset.
Result<std::unique_ptr<Screen>> make_screen(const ClientConfig& config, const base::Clock& clock);

}  // namespace macula::client_app
