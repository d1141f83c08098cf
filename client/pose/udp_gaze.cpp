#include "client/pose/udp_gaze.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/math/frames.h"

namespace macula::pose {
namespace {

using nlohmann::json;

constexpr Nanoseconds kOldest = std::chrono::milliseconds{200};
constexpr const char* kForms =
    R"({"direction":[x,y,z]} or {"picture":[u,v]}, with "age_ms", "confidence", "valid" as needed)";

Error wrong(const std::string& what) {
  return {what, "gaze packet", kForms};
}

/// `count` finite numbers; nullopt: the member is not there.
Result<std::optional<DVec3>> numbers(const json& packet, const char* member, std::size_t count) {
  const auto found = packet.find(member);
  if (found == packet.end()) return std::optional<DVec3>{};
  if (!found->is_array() || found->size() != count)
    return tl::unexpected(wrong(base::concat(member, " is not ", count, " numbers")));
  DVec3 values{0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const json& value = (*found)[i];
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      return tl::unexpected(wrong(base::concat(member, " is not ", count, " numbers")));
    values[static_cast<int>(i)] = value.get<double>();
  }
  return std::optional(values);
}

Result<double> number_within(const json& packet, const char* member, double standard, double low,
                             double high) {
  const auto found = packet.find(member);
  if (found == packet.end()) return standard;
  const double value = found->is_number() ? found->get<double>() : low - 1.0;
  if (value >= low && value <= high) return value;
  return tl::unexpected(wrong(base::concat(member, " is not within ", low, " and ", high)));
}

Result<Vec3> direction_of(const json& packet, const Fov& fov) {
  const auto direction = numbers(packet, "direction", 3);
  if (!direction) return base::forward(direction);
  if (*direction) {
    const double length = glm::length(**direction);
    if (length > 0.0) return Vec3(**direction / length);
    return tl::unexpected(wrong("direction has no length"));
  }
  const auto picture = numbers(packet, "picture", 2);
  if (!picture) return base::forward(picture);
  if (!*picture) return tl::unexpected(wrong("neither direction nor picture is there"));
  const DVec2 tangent = glm::mix(fov.tangent_min(), fov.tangent_max(), DVec2(**picture));
  return Vec3(glm::normalize(math::direction_from_tangent(tangent)));
}

Result<sockaddr_in> parse_address(const std::string& text) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const auto colon = text.rfind(':');
  unsigned port = 0;
  const char* const end = text.data() + text.size();
  const bool is_host = colon != std::string::npos &&
                       inet_pton(AF_INET, text.substr(0, colon).c_str(), &address.sin_addr) == 1;
  const auto parsed = is_host ? std::from_chars(text.data() + colon + 1, end, port)
                              : std::from_chars_result{end, std::errc::invalid_argument};
  if (parsed.ec != std::errc{} || parsed.ptr != end || port > 65535)
    return base::bad_input(base::concat("'", text, "' is not an address"), "--gaze",
                           "udp://HOST:PORT with a numeric host, such as udp://127.0.0.1:7790");
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

}  // namespace

Result<GazePacket> parse_gaze_packet(std::string_view text, const Fov& fov) {
  const json packet = json::parse(text, nullptr, false);
  if (!packet.is_object()) return tl::unexpected(wrong("it is no JSON object"));
  const auto age_ms = number_within(packet, "age_ms", 0.0, 0.0, 1000.0);
  if (!age_ms) return base::forward(age_ms);
  const auto confidence = number_within(packet, "confidence", 1.0, 0.0, 1.0);
  if (!confidence) return base::forward(confidence);
  GazePacket result{{.confidence = static_cast<float>(*confidence)}, units::from_ms(*age_ms)};
  const auto valid = packet.find("valid");
  if (valid != packet.end() && !valid->is_boolean())
    return tl::unexpected(wrong("valid is neither true nor false"));
  result.gaze.valid = valid == packet.end() || valid->get<bool>();
  if (!result.gaze.valid) return result;
  const auto direction = direction_of(packet, fov);
  if (!direction) return base::forward(direction);
  result.gaze.direction = *direction;
  return result;
}

Result<std::unique_ptr<UdpGaze>> UdpGaze::create(const std::string& address, const Fov& fov,
                                                 const base::Clock& clock) {
  const auto where = parse_address(address);
  if (!where) return base::forward(where);
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0 ||
      ::bind(socket, reinterpret_cast<const sockaddr*>(&*where), sizeof(*where)) != 0) {
    const std::string reason = std::strerror(errno);
    if (socket >= 0) ::close(socket);
    return base::bad_input("cannot listen there: " + reason, "--gaze udp://" + address,
                           "an address of this machine and a port that nobody else has");
  }
  return std::unique_ptr<UdpGaze>(new UdpGaze(socket, fov, clock));
}

UdpGaze::UdpGaze(int socket, const Fov& fov, const base::Clock& clock)
    : socket_(socket), fov_(fov), clock_(clock) {
  newest_.gaze = {.valid = false, .confidence = 0.0F};
}

UdpGaze::~UdpGaze() {
  ::close(socket_);
}

int UdpGaze::port() const {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

void UdpGaze::take_packets() {
  std::array<char, 2048> bytes;
  for (ssize_t size = 0; (size = ::recv(socket_, bytes.data(), bytes.size(), 0)) >= 0;) {
    const auto packet = parse_gaze_packet({bytes.data(), static_cast<std::size_t>(size)}, fov_);
    if (packet) {
      newest_ = {packet->gaze, ClientTime{clock_.now()} - packet->age};
    } else if (!std::exchange(complained_, true)) {
      base::log_warning(packet.error().message() + "; later ones are passed over in silence");
    }
  }
}

GazeSample UdpGaze::sample(ClientTime at, const Pose&) {
  take_packets();
  GazeSample sample = newest_;
  if (at - sample.at > kOldest) sample.gaze.valid = false;
  return sample;
}

}  // namespace macula::pose
