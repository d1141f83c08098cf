// Plain structs <-> generated messages, one pair a message. For wire*.cpp only: everyone else
// speaks wire.h. Reading checks counts and enums; values of a ViewState are left to
// check_view_state, because its acks are good even where its pose is not.
#pragma once

#include "shared/base/result.h"
#include "shared/net/messages.h"

namespace macula::v1 {
class Acks;
class Beat;
class Bye;
class Fov;
class FrameBegin;
class FrameEnd;
class Gaze;
class Hello;
class PixelGrid;
class Ping;
class Pong;
class Pose;
class Rect;
class Refusal;
class Settings;
class Slice;
class Tone;
class ViewState;
class Welcome;
}  // namespace macula::v1

namespace macula::net::wire {

// wire_geometry.cpp
void write(const Pose& pose, v1::Pose& out);
void write(const Fov& fov, v1::Fov& out);
void write(const Gaze& gaze, v1::Gaze& out);
void write(const PixelGrid& grid, v1::PixelGrid& out);
void write(const image::Tone& tone, v1::Tone& out);
void write(const image::Rect& rect, v1::Rect& out);
Pose read(const v1::Pose& in);
Fov read(const v1::Fov& in);
Gaze read(const v1::Gaze& in);
PixelGrid read(const v1::PixelGrid& in);
Result<image::Tone> read(const v1::Tone& in);
/// Coordinates above 2^20 are refused: sums of them stay far from overflow.
Result<image::Rect> read(const v1::Rect& in);

// wire_session.cpp
void write(const Hello& hello, v1::Hello& out);
void write(const Welcome& welcome, v1::Welcome& out);
void write(const Refusal& refusal, v1::Refusal& out);
void write(const Settings& settings, v1::Settings& out);
void write(const Bye& bye, v1::Bye& out);
Result<Hello> read(const v1::Hello& in, const Limits& limits);
Result<Welcome> read(const v1::Welcome& in, const Limits& limits);
Refusal read(const v1::Refusal& in);
Result<Settings> read(const v1::Settings& in);
Bye read(const v1::Bye& in);

// wire_view.cpp
void write(const ViewState& view, v1::ViewState& out);
void write(const Acks& acks, v1::Acks& out);
Result<ViewState> read(const v1::ViewState& in);
Acks read(const v1::Acks& in);

// wire_frame.cpp
void write(const FrameBegin& begin, v1::FrameBegin& out);
void write(const SliceHeader& slice, v1::Slice& out);
void write(const FrameEnd& end, v1::FrameEnd& out);
Result<FrameBegin> read(const v1::FrameBegin& in, const Limits& limits);
SliceHeader read(const v1::Slice& in);
Result<FrameEnd> read(const v1::FrameEnd& in);

// wire_telemetry.cpp
void write(const Ping& ping, v1::Ping& out);
void write(const Pong& pong, v1::Pong& out);
void write(const Beat& beat, v1::Beat& out);
Ping read(const v1::Ping& in);
Result<Pong> read(const v1::Pong& in);
Result<Beat> read(const v1::Beat& in);

/// Within 73 years of the clock's origin: differences of two such times cannot overflow.
template <class Time>
bool is_plausible(Time time) {
  constexpr std::int64_t kFarthest_ns = std::int64_t{1} << 61;
  const std::int64_t ns = time.time_since_epoch().count();
  return -kFarthest_ns < ns && ns < kFarthest_ns;
}
inline bool is_plausible(Nanoseconds duration) {
  return is_plausible(ClientTime{duration});
}
template <class Time>
std::int64_t ns_of(Time time) {
  return time.time_since_epoch().count();
}
inline ClientTime client_time(std::int64_t ns) {
  return ClientTime{Nanoseconds{ns}};
}
inline ServerTime server_time(std::int64_t ns) {
  return ServerTime{Nanoseconds{ns}};
}

}  // namespace macula::net::wire
