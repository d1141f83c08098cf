#include <macula/v1/session.pb.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shared/base/text.h"
#include "shared/net/wire_parts.h"

namespace macula::net::wire {
namespace {

constexpr int kMostNames = 64;  ///< codecs or abilities in one message

void write_token(const ResumeToken& token, std::string& out) {
  out.assign(reinterpret_cast<const char*>(token.data()), token.size());
}

Result<ResumeToken> read_token(const std::string& in) {
  ResumeToken token{};
  if (in.size() != token.size()) {
    return base::bad_input(base::concat(in.size(), " bytes"), "resume_token", "16 bytes");
  }
  std::memcpy(token.data(), in.data(), token.size());
  return token;
}

Result<foveation::Display> read_display(const v1::Display& in, const Limits& limits) {
  const auto most = static_cast<std::uint32_t>(limits.max_side_px);
  const auto fits = [&](std::uint32_t side) { return side >= 1 && side <= most; };
  if (!fits(in.width_px()) || !fits(in.height_px())) {
    return base::bad_input(base::concat(in.width_px(), " x ", in.height_px(), " px"), "hello.eyes",
                           base::concat("1..", most, " pixels a side"));
  }
  const Fov fov = read(in.fov());
  if (!is_valid(fov)) {
    return base::bad_input("no field of view", "hello.eyes.fov",
                           "half-angles inside +-90 degrees, left < right, down < up");
  }
  return foveation::Display{fov, static_cast<int>(in.width_px()), static_cast<int>(in.height_px())};
}

template <class Names>
std::vector<std::string> strings_of(const Names& names) {
  return {names.begin(), names.end()};
}

}  // namespace

void write(const Settings& settings, v1::Settings& out) {
  out.set_generation(settings.generation);
  out.set_color_codec(settings.color_codec);
  out.set_jpeg_quality(static_cast<std::uint32_t>(std::max(0, settings.jpeg_quality)));
  out.set_rate_model(settings.rate_model);
  out.set_fovea_oversampling(settings.fovea_oversampling);
}

Result<Settings> read(const v1::Settings& in) {
  constexpr double kMostOversampling = 8.0;
  if (in.jpeg_quality() > 100) {
    return base::bad_input(base::concat(in.jpeg_quality()), "settings.jpeg_quality", "0..100");
  }
  const double oversampling = in.fovea_oversampling();
  if (!(oversampling >= 0.0 && oversampling <= kMostOversampling)) {
    return base::bad_input(base::concat(oversampling), "settings.fovea_oversampling", "0..8");
  }
  return Settings{in.generation(), in.color_codec(), static_cast<int>(in.jpeg_quality()),
                  in.rate_model(), oversampling};
}

void write(const Hello& hello, v1::Hello& out) {
  out.set_protocol_version(hello.protocol_version);
  out.set_program(hello.program);
  for (const foveation::Display& eye : hello.eyes) {
    v1::Display& display = *out.add_eyes();
    write(eye.fov, *display.mutable_fov());
    display.set_width_px(static_cast<std::uint32_t>(eye.width_px));
    display.set_height_px(static_cast<std::uint32_t>(eye.height_px));
  }
  out.set_refresh_hz(hello.refresh_hz);
  out.mutable_codecs()->Add(hello.codecs.begin(), hello.codecs.end());
  out.mutable_abilities()->Add(hello.abilities.begin(), hello.abilities.end());
  if (hello.resume_token) write_token(*hello.resume_token, *out.mutable_resume_token());
  write(hello.settings, *out.mutable_settings());
}

Result<Hello> read(const v1::Hello& in, const Limits& limits) {
  Hello hello;
  hello.protocol_version = in.protocol_version();
  hello.program = in.program();
  // A program of another version may mean something else by the rest; the version alone is
  // answered.
  if (hello.protocol_version != kProtocolVersion) return hello;
  if (in.eyes_size() < 1 || in.eyes_size() > limits.max_views) {
    return base::bad_input(base::concat(in.eyes_size(), " eyes"), "hello.eyes",
                           base::concat("1..", limits.max_views));
  }
  for (const v1::Display& eye : in.eyes()) {
    const auto display = read_display(eye, limits);
    if (!display) return forward(display);
    hello.eyes.push_back(*display);
  }
  hello.refresh_hz = in.refresh_hz();
  if (!(hello.refresh_hz > 0.0 && hello.refresh_hz <= 1000.0)) {
    return base::bad_input(base::concat(hello.refresh_hz), "hello.refresh_hz",
                           "above 0, at most 1000");
  }
  if (in.codecs_size() > kMostNames || in.abilities_size() > kMostNames) {
    return base::bad_input("too many names", "hello.codecs, hello.abilities",
                           base::concat("at most ", kMostNames, " each"));
  }
  hello.codecs = strings_of(in.codecs());
  hello.abilities = strings_of(in.abilities());
  if (!in.resume_token().empty()) {
    const auto token = read_token(in.resume_token());
    if (!token) return forward(token);
    hello.resume_token = *token;
  }
  auto settings = read(in.settings());
  if (!settings) return forward(settings);
  hello.settings = std::move(*settings);
  return hello;
}

void write(const Welcome& welcome, v1::Welcome& out) {
  out.set_protocol_version(welcome.protocol_version);
  out.set_session(welcome.session);
  out.set_epoch(welcome.epoch);
  write_token(welcome.resume_token, *out.mutable_resume_token());
  out.set_color_codec(welcome.color_codec);
  out.set_kernel(welcome.kernel);
  out.set_frame_window(welcome.frame_window);
  out.set_max_part_bytes(welcome.max_part_bytes);
  v1::SceneSummary& scene = *out.mutable_scene();
  scene.set_name(welcome.scene.name);
  scene.set_triangles(welcome.scene.triangles);
  scene.set_lights(welcome.scene.lights);
  write(welcome.scene.scene_from_stage, *scene.mutable_scene_from_stage());
  out.mutable_abilities()->Add(welcome.abilities.begin(), welcome.abilities.end());
}

Result<Welcome> read(const v1::Welcome& in, const Limits& limits) {
  const auto token = read_token(in.resume_token());
  if (!token) return forward(token);
  const Pose scene_from_stage = read(in.scene().scene_from_stage());
  if (!is_valid(scene_from_stage)) return base::bad_input("no pose", "welcome.scene_from_stage");
  if (in.max_part_bytes() == 0 || in.max_part_bytes() > limits.max_part_bytes) {
    return base::bad_input(base::concat(in.max_part_bytes()), "welcome.max_part_bytes",
                           base::concat("1..", limits.max_part_bytes));
  }
  if (in.abilities_size() > kMostNames) {
    return base::bad_input(base::concat(in.abilities_size(), " names"), "welcome.abilities",
                           base::concat("at most ", kMostNames));
  }
  Welcome welcome;
  welcome.protocol_version = in.protocol_version();
  welcome.session = in.session();
  welcome.epoch = in.epoch();
  welcome.resume_token = *token;
  welcome.color_codec = in.color_codec();
  welcome.kernel = in.kernel();
  welcome.frame_window = in.frame_window();
  welcome.max_part_bytes = in.max_part_bytes();
  welcome.scene = {in.scene().name(), in.scene().triangles(), in.scene().lights(),
                   scene_from_stage};
  welcome.abilities = strings_of(in.abilities());
  return welcome;
}

void write(const Refusal& refusal, v1::Refusal& out) {
  out.set_code(static_cast<v1::Refusal::Code>(refusal.code));
  out.set_text(refusal.text);
}

Refusal read(const v1::Refusal& in) {
  // A code of a later version still refuses; its text says why.
  const bool known = v1::Refusal::Code_IsValid(in.code());
  return {known ? static_cast<RefusalCode>(in.code()) : RefusalCode::Unspecified, in.text()};
}

void write(const Bye& bye, v1::Bye& out) {
  out.set_reason(bye.reason);
  out.set_retry_after_ms(bye.retry_after_ms);
}

Bye read(const v1::Bye& in) {
  return {in.reason(), in.retry_after_ms()};
}

static_assert(static_cast<int>(RefusalCode::ServerFull) == v1::Refusal::CODE_SERVER_FULL);
static_assert(static_cast<int>(RefusalCode::UnknownSession) == v1::Refusal::CODE_UNKNOWN_SESSION);

}  // namespace macula::net::wire
