#include "client/app/options.h"

#include <gtest/gtest.h>

namespace macula::client_app {
namespace {

Result<Command> parse(std::vector<const char*> arguments, const Environment& environment = {}) {
  arguments.insert(arguments.begin(), "macula-client");
  return parse_options(static_cast<int>(arguments.size()), arguments.data(), environment);
}

ClientConfig config_of(const std::vector<const char*>& arguments,
                       const Environment& environment = {}) {
  const auto parsed = parse(arguments, environment);
  if (!parsed) {
    ADD_FAILURE() << parsed.error().message();
    return {};
  }
  return std::get<Options>(*parsed).config;
}

std::string complaint(const std::vector<const char*>& arguments) {
  const auto parsed = parse(arguments);
  if (parsed) return "accepted";
  EXPECT_EQ(parsed.error().exit_status(), 2);
  return parsed.error().message();
}

TEST(ClientOptions, FillTheConfigInItsUnits) {
  const ClientConfig config = config_of({"--connect",
                                         "tcp://127.0.0.1:9",
                                         "--keys",
                                         "k",
                                         "--display",
                                         "headless",
                                         "--trace",
                                         "t.csv",
                                         "--frames",
                                         "77",
                                         "--refresh",
                                         "90",
                                         "--size",
                                         "320x200",
                                         "--fov-deg",
                                         "70",
                                         "--eyes",
                                         "1",
                                         "--out",
                                         "o",
                                         "--as-fast-as-possible",
                                         "--codec",
                                         "lossless",
                                         "--oversampling",
                                         "1.5",
                                         "--rate-model",
                                         "ray-small",
                                         "--ipd-mm",
                                         "60",
                                         "--reprojection",
                                         "rotation",
                                         "--loop"});
  EXPECT_EQ(config.connect, "tcp://127.0.0.1:9");
  EXPECT_EQ(config.key_folder, "k");
  EXPECT_EQ(config.display, DisplayKind::Headless);
  EXPECT_EQ(config.trace_file, "t.csv");
  EXPECT_EQ(config.frames, 77U);
  EXPECT_EQ(config.refresh_hz, 90.0);
  EXPECT_EQ(config.width_px, 320);
  EXPECT_EQ(config.height_px, 200);
  EXPECT_EQ(config.vertical_fov, Degrees{70.0});
  EXPECT_EQ(config.eyes, 1);
  EXPECT_EQ(config.out_folder, "o");
  EXPECT_EQ(config.pacing, Pacing::AsFastAsPossible);
  EXPECT_EQ(config.settings.color_codec, "lossless");
  EXPECT_EQ(config.settings.fovea_oversampling, 1.5);
  EXPECT_EQ(config.settings.rate_model, "ray-small");
  EXPECT_DOUBLE_EQ(config.ipd.value(), 0.060);
  EXPECT_EQ(config.warp, ClientConfig::Warp::Rotation);
  EXPECT_EQ(config.repeat_trace, ClientConfig::Repeat::Yes);
}

TEST(ClientOptions, SlowMachinesMayTakeTheCoarseMesh) {
  using reprojection::WarpOptions;
  EXPECT_EQ(config_of({}).warp, ClientConfig::Warp::Mesh);
  const ClientConfig config = config_of({"--reprojection", "grid"});
  EXPECT_EQ(warp_options(config.warp).raster, WarpOptions::Raster::EverySecond);
  EXPECT_EQ(warp_options(config.warp).filter, WarpOptions::Filter::Bilinear);
  EXPECT_EQ(warp_options(config.warp).method, WarpOptions::Method::Mesh);
}

TEST(ClientOptions, OpenAWindowOnlyWhereThereIsADisplay) {
  EXPECT_EQ(config_of({}).display, DisplayKind::Headless);
  EXPECT_EQ(config_of({}, {.display = ""}).display, DisplayKind::Headless);
  EXPECT_EQ(config_of({}, {.display = ":0"}).display, DisplayKind::Window);
  EXPECT_EQ(config_of({}, {.wayland_display = "wayland-0"}).display, DisplayKind::Window);
}

TEST(ClientOptions, KeepPicturesOfAHeadlessRunByDefault) {
  EXPECT_EQ(config_of({"--display", "headless"}).out_folder, "macula-out");
  EXPECT_EQ(config_of({"--display", "window"}).out_folder, "");
}

TEST(ClientOptions, TakeTheKeyFolderFromTheEnvironment) {
  EXPECT_EQ(config_of({}, {.xdg_config_home = "/x"}).key_folder, "/x/macula");
}

TEST(ClientOptions, SayWhatIsWrongAndWhatIsAllowed) {
  EXPECT_NE(complaint({"--nonsense"}).find("--nonsense"), std::string::npos);
  EXPECT_EQ(complaint({"--size", "12"}),
            "--size: '12' is not a size (WxH with 16 to 8192 pixels a side, such as 640x640)");
  for (const char* size : {"640x", "x640", "640x640x", "15x640", "640x9000", "-64x64", "64X64"}) {
    EXPECT_NE(complaint({"--size", size}), "accepted") << size;
  }
  EXPECT_NE(complaint({"--rate-model", "guess"}).find("cortical"), std::string::npos);
  EXPECT_NE(complaint({"--display", "hologram"}).find("headless"), std::string::npos);
  EXPECT_NE(complaint({"--eyes", "3"}), "accepted");
  EXPECT_NE(complaint({"--fov-deg", "nan"}), "accepted");
  EXPECT_NE(complaint({"--refresh", "0"}), "accepted");
  EXPECT_NE(complaint({"--oversampling", "1.3"}), "accepted");
}

TEST(ClientOptions, WarpOnTheWindowsOpenGlOnly) {
  EXPECT_EQ(config_of({"--display", "window"}).warp_on, ClientConfig::WarpOn::Cpu);
  EXPECT_EQ(config_of({"--display", "window", "--warp", "gl"}).warp_on, ClientConfig::WarpOn::Gl);
  EXPECT_NE(complaint({"--display", "headless", "--warp", "gl"}).find("--display window"),
            std::string::npos);
  EXPECT_NE(complaint({"--warp", "vulkan"}), "accepted");
}

TEST(ClientOptions, ShowHelpWithoutRunning) {
  const auto parsed = parse({"--help"});
  ASSERT_TRUE(parsed);
  const std::string& text = std::get<TextAsked>(*parsed).text;
  EXPECT_NE(text.find("--trace"), std::string::npos);
  EXPECT_NE(text.find("--connect"), std::string::npos);
}

TEST(ClientOptions, LeaveToAHeadsetWhatItKnows) {
  const ClientConfig config = config_of({"--display", "openxr"});
  EXPECT_EQ(config.display, DisplayKind::OpenXr);
  EXPECT_EQ(config.width_px, 0);
  EXPECT_EQ(config_of({"--display", "openxr", "--size", "400x300"}).width_px, 400);
  EXPECT_EQ(config_of({"--display", "window"}).width_px, 640);
  for (const std::vector<const char*>& asked : {std::vector{"--trace", "t.csv"},
                                                {"--fov-deg", "90"},
                                                {"--eyes", "1"},
                                                {"--ipd-mm", "60"},
                                                {"--refresh", "90"},
                                                {"--as-fast-as-possible"}}) {
    std::vector<const char*> arguments{"--display", "openxr"};
    arguments.insert(arguments.end(), asked.begin(), asked.end());
    EXPECT_EQ(complaint(arguments), std::string(asked.front()) +
                                        ": the headset itself decides this (leave it out with "
                                        "--display openxr)");
  }
}

TEST(ClientOptions, TakeTheGazeFromWhereItIsToBeHad) {
  using GazeFrom = ClientConfig::GazeFrom;
  EXPECT_EQ(config_of({}).gaze, GazeFrom::Head);
  EXPECT_EQ(config_of({"--gaze", "trace", "--trace", "t.csv"}).gaze, GazeFrom::Head);
  EXPECT_EQ(config_of({"--gaze", "target"}).gaze, GazeFrom::Target);
  EXPECT_EQ(config_of({"--gaze", "mouse", "--display", "window"}).gaze, GazeFrom::Mouse);
  const ClientConfig udp = config_of({"--gaze", "udp://127.0.0.1:7790"});
  EXPECT_EQ(udp.gaze, GazeFrom::Udp);
  EXPECT_EQ(udp.gaze_address, "127.0.0.1:7790");
  EXPECT_EQ(complaint({"--gaze", "trace"}),
            "--gaze trace: there is no trace to take the gaze from (name one with --trace)");
  EXPECT_EQ(complaint({"--gaze", "mouse", "--display", "headless"}),
            "--gaze mouse: there is no window to take the mouse from (use --display window)");
  EXPECT_EQ(complaint({"--gaze", "nose"}),
            "--gaze: 'nose' is no source of a gaze (mouse, trace, target or udp://HOST:PORT)");
}

}  // namespace
}  // namespace macula::client_app
