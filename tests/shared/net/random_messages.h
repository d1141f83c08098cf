// Seeded messages with every field set to a value that the wire's checks allow.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "shared/net/messages.h"

namespace macula::net {

class RandomMessages {
 public:
  explicit RandomMessages(std::uint64_t seed) : random_(seed) {}

  Hello hello() {
    Hello hello;
    hello.program = text();
    hello.eyes = {display(), display()};
    hello.refresh_hz = real(1.0, 144.0);
    hello.codecs = {text(), text()};
    hello.abilities = {text()};
    if (random_() % 2 == 0) hello.resume_token = token();
    hello.settings = settings();
    return hello;
  }
  Welcome welcome() {
    return {kProtocolVersion,
            random_(),
            u32(),
            token(),
            text(),
            text(),
            u32(),
            1 + u32() % 65536,
            {text(), random_(), random_(), pose()},
            {text(), text()}};
  }
  Refusal refusal() { return {static_cast<RefusalCode>(random_() % 5), text()}; }
  Settings settings() {
    return {u32(), text(), static_cast<int>(random_() % 101), text(), real(0.0, 4.0)};
  }
  Bye bye() { return {text(), u32()}; }
  Acks acks() { return {u32(), random_(), random_(), random_(), random_() % 2 == 0}; }
  ViewState view_state() {
    return {random_(), client_time(), client_time(), pose(), {eye(), eye()}, client_time(), acks()};
  }
  FrameBegin frame_begin() {
    FrameBegin begin;
    begin.epoch = u32();
    begin.frame = 1 + random_() / 2;
    begin.view_sequence = random_();
    begin.view_sampled = client_time();
    begin.view_predicted_display = client_time();
    begin.gaze_sampled = client_time();
    begin.horizon = Nanoseconds{static_cast<std::int64_t>(u32())};
    begin.guard_band = Radians{real(0.0, 1.0)};
    begin.view_cell_m = real(0.0, 0.1);
    begin.quality = {real(0.4, 1.0), 1 << (random_() % 4), random_() % 100000, random_() % 2 == 0,
                     real(0, 10)};
    begin.views = {frame_view(), frame_view()};
    begin.kernel = text();
    begin.config = text();
    begin.seed = random_();
    begin.scene_time = Nanoseconds{ns()};
    for (std::uint32_t eye = 0; eye < 2; ++eye) {
      begin.slices.push_back(
          {eye, 1, PlaneKind::Color, SliceCodec::Jpeg, {0, 8, 40, 20}, 1 + u32() % 9999});
      begin.slices.push_back(
          {eye, 1, PlaneKind::Depth, SliceCodec::InverseDepth, {0, 0, 48, 36}, 1 + u32() % 9999});
    }
    begin.is_key = random_() % 2 == 0;
    begin.reference_frame = random_();
    begin.motions = {{u32(), pose()}};
    begin.settings_generation = u32();
    begin.previous_frame = random_();
    begin.previous_send_begin = server_time();
    begin.previous_send_end = server_time();
    return begin;
  }
  SliceHeader slice() { return {u32(), random_(), u32(), u32()}; }
  FrameEnd frame_end() {
    return {u32(),         random_(),     server_time(), server_time(), server_time(),
            server_time(), server_time(), random_(),     random_(),     random_()};
  }
  Ping ping() { return {random_(), client_time()}; }
  Pong pong() { return {random_(), client_time(), server_time(), server_time()}; }
  Beat beat() { return {random_(), server_time()}; }

  std::vector<Message> one_of_each() {
    return {hello(), welcome(),   refusal(),     settings(), bye(),  view_state(), acks(),
            slice(), frame_end(), frame_begin(), ping(),     pong(), beat()};
  }

 private:
  std::uint32_t u32() { return static_cast<std::uint32_t>(random_()); }
  double real(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  std::string text() {
    std::string text(random_() % 20, 'a');
    for (char& c : text) c = static_cast<char>('a' + random_() % 26);
    return text;
  }
  ResumeToken token() {
    ResumeToken token{};
    for (std::byte& byte : token) byte = static_cast<std::byte>(random_());
    return token;
  }
  std::int64_t ns() { return static_cast<std::int64_t>(random_() >> 4) - (std::int64_t{1} << 59); }
  ClientTime client_time() { return ClientTime{Nanoseconds{ns()}}; }
  ServerTime server_time() { return ServerTime{Nanoseconds{ns()}}; }
  Pose pose() {
    const DQuat q(real(-1, 1), real(-1, 1), real(-1, 1), real(0.1, 1));
    return {{real(-9, 9), real(-9, 9), real(-9, 9)}, glm::normalize(q)};
  }
  Fov fov() {
    return {Radians{real(-1, -0.1)}, Radians{real(0.1, 1)}, Radians{real(0.1, 1)},
            Radians{real(-1, -0.1)}};
  }
  Gaze gaze() {
    const auto f = [this] { return static_cast<float>(real(-0.5, 0.5)); };
    return {glm::normalize(Vec3(f(), f(), -1.0F)), random_() % 2 == 0,
            static_cast<float>(real(0, 1))};
  }
  EyeState eye() { return {pose(), fov(), gaze()}; }
  foveation::Display display() {
    return {fov(), 1 + static_cast<int>(u32() % 4000), 1 + static_cast<int>(u32() % 4000)};
  }
  std::vector<float> edges(int cells) {
    std::vector<float> edges{-1.0F};
    for (int i = 0; i < cells; ++i)
      edges.push_back(edges.back() + static_cast<float>(real(0.01, 0.05)));
    return edges;
  }
  FrameView frame_view() {
    FrameView view;
    view.stage_from_view = pose();
    view.display_fov = fov();
    view.gaze = gaze();
    view.grid = {edges(48), edges(36)};
    view.tone = {static_cast<float>(real(-4, 4)),
                 random_() % 2 == 0 ? image::ToneCurve::Linear : image::ToneCurve::Filmic};
    view.depth_inverse_scale_per_m = static_cast<float>(real(0.1, 20));
    view.hidden_depth_inverse_scale_per_m = static_cast<float>(real(0.1, 20));
    view.depth_residual.resize(6 * 5);
    for (std::uint8_t& residual : view.depth_residual)
      residual = static_cast<std::uint8_t>(random_());
    return view;
  }

  std::mt19937_64 random_;
};

}  // namespace macula::net
