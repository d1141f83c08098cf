#include "server/exporter/exporter.h"

#include <prometheus/collectable.h>
#include <prometheus/exposer.h>
#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

namespace macula::exporter {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using session::StageTimes;
using session::Telemetry;

/// A value under one label, or under none where the label's name is empty.
struct Sample {
  std::string label, value;
  double number = 0.0;
};

class Page {
 public:
  void counter(const char* name, const char* help, const std::vector<Sample>& samples) {
    add(name, help, MetricType::Counter, samples,
        [](ClientMetric& metric, double number) { metric.counter.value = number; });
  }
  void gauge(const char* name, const char* help, const std::vector<Sample>& samples) {
    add(name, help, MetricType::Gauge, samples,
        [](ClientMetric& metric, double number) { metric.gauge.value = number; });
  }
  std::vector<MetricFamily> take() { return std::move(families_); }

 private:
  template <class Set>
  void add(const char* name, const char* help, MetricType type, const std::vector<Sample>& samples,
           Set&& set) {
    MetricFamily& family = families_.emplace_back();
    family.name = name;
    family.help = help;
    family.type = type;
    for (const Sample& sample : samples) {
      ClientMetric& metric = family.metric.emplace_back();
      if (!sample.label.empty()) metric.label.push_back({sample.label, sample.value});
      set(metric, sample.number);
    }
  }
  std::vector<MetricFamily> families_;
};

template <class Integer>
double number(Integer value) {
  return static_cast<double>(value);
}

/// Seconds; 0 where there is none.
double quantile_s(std::vector<double> times_ms, double q) {
  if (times_ms.empty()) return 0.0;
  const auto place = static_cast<std::ptrdiff_t>(q * number(times_ms.size() - 1));
  std::nth_element(times_ms.begin(), times_ms.begin() + place, times_ms.end());
  return 1e-3 * times_ms[static_cast<std::size_t>(place)];
}

template <class Part>
std::vector<double> times_of(const Telemetry& telemetry, Part&& part) {
  std::vector<double> times;
  for (const StageTimes& stages : telemetry.recent) times.push_back(part(stages));
  return times;
}

void add_frames(Page& page, const Telemetry& t) {
  page.counter("macula_frames_total", "Frames by what became of them",
               {{"outcome", "rendered", number(t.frames_rendered)},
                {"outcome", "encoded", number(t.frames_encoded)},
                {"outcome", "sent", number(t.net.frames_sent)},
                {"outcome", "stopped", number(t.frames_stopped)},
                {"outcome", "failed", number(t.frames_failed)},
                {"outcome", "abandoned", number(t.sessions.frames_abandoned)},
                {"outcome", "lost_on_the_way", number(t.sessions.frames_lost)},
                {"outcome", "lost_at_the_socket", number(t.net.frames_lost)}});
  page.counter("macula_rays_total", "Primary and shadow rays", {{"", "", number(t.rays)}});
  page.counter("macula_cells_total", "Cells rendered", {{"", "", number(t.cells)}});
  page.counter("macula_non_finite_samples_total", "Samples that were no numbers and were left out",
               {{"", "", number(t.non_finite_samples)}});
}

void add_times(Page& page, const Telemetry& t) {
  std::vector<Sample> medians, tails;
  const auto stage = [&](const char* name, const std::vector<double>& times_ms) {
    medians.push_back({"stage", name, quantile_s(times_ms, 0.5)});
    tails.push_back({"stage", name, quantile_s(times_ms, 0.95)});
  };
  stage("view_wait", times_of(t, [](const StageTimes& s) { return s.view_wait_ms; }));
  stage("render", times_of(t, [](const StageTimes& s) { return s.render_ms; }));
  stage("encode", times_of(t, [](const StageTimes& s) { return s.encode_ms; }));
  stage("send", t.recent_send_ms);
  page.gauge("macula_stage_median_seconds", "Stages of the last 64 frames", medians);
  page.gauge("macula_stage_p95_seconds", "Stages of the last 64 frames", tails);
  const auto age =
      times_of(t, [](const StageTimes& s) { return s.view_wait_ms + s.render_ms + s.encode_ms; });
  page.gauge(
      "macula_frame_age_seconds",
      "From the arrival of a frame's view to its last byte encoded, last 64 frames",
      {{"quantile", "0.5", quantile_s(age, 0.5)}, {"quantile", "0.95", quantile_s(age, 0.95)}});
}

void add_sessions(Page& page, const Telemetry& t) {
  page.gauge("macula_sessions", "Sessions alive", {{"", "", number(t.now.size())}});
  page.counter("macula_session_events_total", "What became of Hellos and sessions",
               {{"event", "welcomed", number(t.table.welcomed)},
                {"event", "resumed", number(t.table.resumed)},
                {"event", "refused", number(t.table.refused)},
                {"event", "dropped", number(t.table.dropped)}});
  double in_flight = 0.0, unsent = 0.0, slowest = 0.0;
  for (const session::SessionState& now : t.now) {
    in_flight += now.in_flight;
    unsent += now.unsent;
    if (now.link_bytes_per_s <= 0.0) continue;  // not known yet
    slowest = slowest == 0.0 ? now.link_bytes_per_s : std::min(slowest, now.link_bytes_per_s);
  }
  page.gauge("macula_frames_in_flight", "Sent or waiting and not acknowledged, all sessions",
             {{"", "", in_flight}});
  page.gauge("macula_frames_unsent", "Encoded and not sent, all sessions", {{"", "", unsent}});
  page.gauge("macula_slowest_link_bytes_per_second", "As acknowledged; 0: not known",
             {{"", "", slowest}});
  page.gauge("macula_governor_scale", "Scale of the periphery's resolution of the newest frame",
             {{"", "", t.newest_scale}});
}

void add_drops(Page& page, const Telemetry& t) {
  page.counter("macula_views_total", "Head poses by what became of them",
               {{"outcome", "taken", number(t.sessions.views)},
                {"outcome", "stale", number(t.sessions.stale_views)},
                {"outcome", "invalid", number(t.sessions.invalid_views)},
                {"outcome", "rejected", number(t.net.rejected_views)}});
  page.counter("macula_messages_malformed_total", "Messages that could not be understood",
               {{"", "", number(t.net.malformed)}});
  page.counter("macula_handshakes_refused_total", "Connections without an allowed key",
               {{"", "", number(t.net.refused_handshakes)}});
  page.counter("macula_acks_refused_total", "Acknowledgements of frames that were never sent",
               {{"", "", number(t.sessions.acks_refused)}});
  page.counter("macula_keys_wanted_total", "Key frames wanted by clients that lost a frame",
               {{"", "", number(t.sessions.keys_wanted)}});
}

std::vector<MetricFamily> families_of(const Telemetry& telemetry) {
  Page page;
  add_frames(page, telemetry);
  add_times(page, telemetry);
  add_sessions(page, telemetry);
  add_drops(page, telemetry);
  return page.take();
}

class Source final : public prometheus::Collectable {
 public:
  explicit Source(Exporter::Read read) : read_(std::move(read)) {}
  std::vector<MetricFamily> Collect() const override { return families_of(read_()); }

 private:
  Exporter::Read read_;
};

class Server final : public Exporter {
 public:
  Server(const std::string& address, Read read)
      : source_(std::make_shared<Source>(std::move(read))), exposer_(address, 1) {
    exposer_.RegisterCollectable(source_);
  }
  int port() const override { return exposer_.GetListeningPorts().front(); }

 private:
  std::shared_ptr<Source> source_;
  prometheus::Exposer exposer_;
};

}  // namespace

Result<std::unique_ptr<Exporter>> Exporter::create(const std::string& address, Read read) {
  try {
    return std::make_unique<Server>(address, std::move(read));
  } catch (const std::exception&) {
    return base::bad_input("cannot serve metrics at " + address, "--metrics",
                           "ADDRESS:PORT of this machine that nobody listens on, such as "
                           "127.0.0.1:9464");
  }
}

std::string page_of(const session::Telemetry& telemetry) {
  return prometheus::TextSerializer().Serialize(families_of(telemetry));
}

}  // namespace macula::exporter
