#include "server/exporter/exporter.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace macula::exporter {
namespace {

session::Telemetry telemetry() {
  session::Telemetry t;
  t.frames_rendered = 120;
  t.net.frames_lost = 3;
  t.newest_scale = 0.75;
  for (int i = 1; i <= 21; ++i) t.recent.push_back({1.0, static_cast<double>(i), 2.0, 0.0});
  t.now.push_back({.session = 77, .in_flight = 2, .unsent = 1, .link_bytes_per_s = 5e6});
  t.now.push_back({.session = 78, .in_flight = 1, .link_bytes_per_s = 2e6});
  t.now.push_back({.session = 79});
  return t;
}

bool has_line(const std::string& page, const std::string& line) {
  return ("\n" + page).find("\n" + line + "\n") != std::string::npos;
}

TEST(Exporter, TellsFramesStagesAgesDropsSessionsAndTheGovernor) {
  const std::string page = page_of(telemetry());
  for (const char* line :
       {"# TYPE macula_frames_total counter", "macula_frames_total{outcome=\"rendered\"} 120",
        "macula_frames_total{outcome=\"lost_at_the_socket\"} 3", "macula_sessions 3",
        "macula_frames_in_flight 3", "macula_frames_unsent 1",
        "macula_slowest_link_bytes_per_second 2000000", "macula_governor_scale 0.75"})
    EXPECT_TRUE(has_line(page, line)) << line << "\nin\n" << page;
  // Of 1..21 ms the median is 11; an age is 3 ms more.
  EXPECT_NE(page.find("macula_stage_median_seconds{stage=\"render\"} 0.011"), std::string::npos);
  EXPECT_NE(page.find("macula_frame_age_seconds{quantile=\"0.5\"} 0.014"), std::string::npos)
      << page;
}

TEST(Exporter, NamesNoSessionAndNoKey) {
  const std::string page = page_of(telemetry());
  for (const char* secret : {"77", "78", "79"}) EXPECT_EQ(page.find(secret), std::string::npos);
}

TEST(Exporter, TellsEverythingTheDashboardShowsAndTheDashboardEverythingItTells) {
  std::ifstream file(MACULA_SOURCE_DIR "/deploy/grafana/macula-server.json");
  const std::string dashboard{std::istreambuf_iterator<char>(file), {}};
  const auto names_in = [](const std::string& text) {
    static const std::regex name("macula_[a-z0-9_]+");
    return std::set<std::string>(std::sregex_token_iterator(text.begin(), text.end(), name), {});
  };
  EXPECT_EQ(names_in(dashboard), names_in(page_of(telemetry())));
}

/// What an HTTP server on loopback answers.
std::string get(int port, const std::string& path) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    const std::string request = "GET " + path + " HTTP/1.0\r\n\r\n";
    EXPECT_EQ(::send(socket, request.data(), request.size(), 0),
              static_cast<ssize_t>(request.size()));
    std::array<char, 4096> chunk{};
    for (ssize_t count = 0; (count = ::recv(socket, chunk.data(), chunk.size(), 0)) > 0;)
      answer.append(chunk.data(), static_cast<std::size_t>(count));
  }
  ::close(socket);
  return answer;
}

TEST(Exporter, ServesTheValuesOfTheMoment) {
  std::uint64_t rendered = 7;
  const auto exporter = Exporter::create("127.0.0.1:0", [&] {
    session::Telemetry t;
    t.frames_rendered = rendered;
    return t;
  });
  ASSERT_TRUE(exporter) << exporter.error().message();
  const int port = (*exporter)->port();
  EXPECT_NE(get(port, "/metrics").find("macula_frames_total{outcome=\"rendered\"} 7\n"),
            std::string::npos);
  rendered = 8;
  EXPECT_NE(get(port, "/metrics").find("macula_frames_total{outcome=\"rendered\"} 8\n"),
            std::string::npos);
  EXPECT_EQ(get(port, "/").find("macula_frames_total"), std::string::npos) << "nowhere else";
}

TEST(Exporter, SaysWhatAnAddressMustBe) {
  const auto exporter = Exporter::create("203.0.113.1:9464", [] { return session::Telemetry{}; });
  ASSERT_FALSE(exporter);
  EXPECT_NE(exporter.error().message().find("127.0.0.1:9464"), std::string::npos);
}

}  // namespace
}  // namespace macula::exporter
