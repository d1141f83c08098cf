#include "server/session/server.h"

#include <bit>
#include <new>
#include <utility>

#include "shared/base/free_memory.h"
#include "shared/base/log.h"
#include "shared/base/text.h"

namespace macula::session {
namespace {

constexpr std::size_t kJobs = 2;  // one renders while the other encodes
constexpr std::size_t kRecentFrames = 64;
constexpr Nanoseconds kTick = std::chrono::milliseconds{10};

/// The rules with what the rest of the configuration says about them.
SessionRules rules_of(const ServerConfig& config) {
  SessionRules rules = config.rules;
  rules.goals = {config.target_frame_time, config.age_goal, config.ladder, config.quality,
                 config.most_rmse};
  rules.gaze.base_radius = config.views.full_rate_radius;
  return rules;
}

/// The next value, however long it takes; nullopt once the channel is closed and empty.
template <class T>
std::optional<T> next_of(base::Channel<T>& channel) {
  for (;;) {
    if (auto value = channel.wait(std::chrono::minutes{1})) return value;
    if (channel.closed()) return std::nullopt;
  }
}

/// Where the encoder would take its threads' cores from the renderer, no more frames are made by
/// doing both at once, and each one later.
bool can_overlap(const ServerConfig& config, const scheduling::TileScheduler& scheduler) {
  return scheduler.threads() > config.encode_threads;
}

template <class T>
void push_recent(std::vector<T>& recent, T value) {
  if (recent.size() == kRecentFrames) recent.erase(recent.begin());
  recent.push_back(std::move(value));
}

StageTimes stage_times(const FrameJob& job) {
  return {units::to_ms(job.render_begin - job.start.view_received),
          units::to_ms(job.render_end - job.render_begin),
          units::to_ms(job.encode_end - job.render_end), units::to_ms(job.encode_cpu)};
}

/// What `work` returns; memory that is not to be had is an error of this frame, not the end of the
/// server.
template <class Work>
auto within_memory(Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return base::runtime_error("there is not enough memory for it", "frame",
                               "a smaller picture, fewer clients, or more memory");
  }
}

Result<void> check_config(const ServerConfig& config) {
  if (config.jpeg_quality < 1 || config.jpeg_quality > 100)
    return base::bad_input(base::concat("JPEG quality ", config.jpeg_quality), "color-quality",
                           "1 to 100");
  if (config.age_goal && *config.age_goal <= Nanoseconds::zero())
    return base::bad_input("the goal for the age of frames is not positive", "age-ms");
  if (config.target_frame_time && *config.target_frame_time <= Nanoseconds::zero())
    return base::bad_input("the target frame time is not positive", "target-ms");
  net::Settings settings;
  settings.color_codec =
      config.offer.default_codec == kAutoCodec ? std::string{} : config.offer.default_codec;
  settings.fovea_oversampling = config.views.fovea_oversampling;
  return check_settings(settings);
}

}  // namespace

Result<std::unique_ptr<Server>> Server::create(ServerConfig config, ServerParts parts) {
  if (const auto good = check_config(config); !good) return base::forward(good);
  return std::unique_ptr<Server>(new Server(std::move(config), std::move(parts)));
}

Server::Server(ServerConfig config, ServerParts parts)
    : config_(std::move(config)),
      parts_(std::move(parts)),
      render_stage_(config_, parts_.scene, parts_.kernel, parts_.scheduler, *parts_.clock),
      encode_stage_(config_, *parts_.clock),
      overlaps_(can_overlap(config_, *parts_.scheduler)),
      free_jobs_(kJobs),
      rendered_(kJobs),
      table_(rules_of(config_), config_.offer, parts_.random) {
  for (std::size_t i = 0; i < kJobs; ++i)
    MACULA_CHECK(free_jobs_.put(std::make_unique<FrameJob>()), "the channel holds every job");
}

void Server::start() {
  MACULA_CHECK(!control_.joinable(), "a server starts once");
  control_ = std::thread([this] { control_loop(); });
  render_ = std::thread([this] { render_loop(); });
  encode_ = std::thread([this] { encode_loop(); });
}

void Server::stop(const std::string& reason) {
  {
    std::lock_guard lock(mutex_);
    if (std::exchange(stopping_, true)) return;
    carry_out(table_.stop(reason));
  }
  may_start_.notify_all();
  free_jobs_.close();
  rendered_.close();
  for (std::thread* thread : {&control_, &render_, &encode_})
    if (thread->joinable()) thread->join();
  if (!parts_.log) return;
  if (const auto written = parts_.log->finish(telemetry()); !written)
    base::log_warning(written.error().message());
}

void Server::control_loop() {
  ServerTime last_tick = now();
  for (;;) {
    auto event = parts_.endpoint->wait(kTick);
    {
      std::lock_guard lock(mutex_);
      if (stopping_) return;
      if (event) take(*event);
      if (now() - last_tick >= kTick) {
        carry_out(table_.tick(now()));
        last_tick = now();
      }
    }
    may_start_.notify_one();
    if (memory_freed_.exchange(false)) base::return_free_memory();
  }
}

void Server::take(const net::ServerEvent& event) {
  if (const auto* sent = std::get_if<net::FrameSent>(&event); sent != nullptr && !sent->lost)
    push_recent(telemetry_.recent_send_ms, units::to_ms(sent->end - sent->begin));
  if (const auto* sent = std::get_if<net::FrameSent>(&event); sent != nullptr && parts_.log)
    parts_.log->on_sent(*sent);
  carry_out(table_.handle(event, now()));
}

std::shared_ptr<RenderMemory> Server::memory_of(const FrameKey& key) {
  std::shared_ptr<RenderMemory>& memory = memories_[key.session];
  if (!memory || memory->epoch != key.epoch) {
    // Whichever thread lets go of it last: only then has the system something to get back.
    memory = {new RenderMemory, [this](const RenderMemory* freed) {
                delete freed;
                memory_freed_ = true;
              }};
    memory->epoch = key.epoch;
  }
  return memory;
}

std::optional<Server::NextFrame> Server::wait_for_frame() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (stopping_) return std::nullopt;
    const bool waits = encoding_ && !overlaps_;
    if (auto start = waits ? std::nullopt : table_.next_frame(now())) {
      rendering_.emplace(Rendering{start->key, {}});
      auto memory = memory_of(start->key);
      return NextFrame{std::move(*start), std::move(memory), rendering_->stop.get_token()};
    }
    may_start_.wait(lock);
  }
}

void Server::render_loop() {
  while (auto job = next_of(free_jobs_)) {
    auto next = wait_for_frame();
    if (!next) return;
    render(std::move(*job), std::move(*next));
  }
}

void Server::render(Job job, NextFrame next) {
  job->start = std::move(next.start);
  job->encode_memory = {next.memory, next.memory->encode.get()};
  job->starts_history = std::exchange(next.memory->history_is_torn, false);
  if (job->starts_history) next.memory->history = {};
  const FrameKey key = job->start.key;
  const ServerTime begun = now();
  const auto outcome =
      within_memory([&] { return render_stage_.render(*job, *next.memory, std::move(next.stop)); });
  if (!outcome) job->buffers = {};  // what was had of them may be what others miss
  const bool rendered = outcome && *outcome == RenderOutcome::Rendered;
  next.memory->history_is_torn = !rendered;
  if (rendered && parts_.recorder) parts_.recorder->add(*job);
  {
    std::lock_guard lock(mutex_);
    rendering_.reset();
    table_.on_rendered(key, now() - begun);
    encoding_ = encoding_ || rendered;
    if (rendered) {
      ++telemetry_.frames_rendered;
      telemetry_.rays += job->report.primary_rays + job->report.shadow_rays;
      telemetry_.cells += job->cells;
      telemetry_.non_finite_samples += job->report.non_finite_samples;
      telemetry_.newest_scale = job->scale;
      telemetry_.newest_quality = job->start.quality.quality;
      telemetry_.measured_rmse = job->start.quality.rmse;
      if (job->error)
        telemetry_.estimated_rmse = table_.on_error_estimated(key, *job->error).value_or(0.0);
      table_.on_frame_rendered(key, job->render_end - job->render_begin);
    } else if (outcome) {
      ++telemetry_.frames_stopped;
      table_.on_frame_abandoned(key);
    } else {
      give_up(key, outcome.error().message());
    }
  }
  if (!rendered) return give_back(std::move(job));
  // Two jobs in channels of two: a put fails only while the server stops.
  (void)rendered_.put(std::move(job));
}

/// A job that waits holds nothing of a session, which may end meanwhile.
void Server::give_back(Job job) {
  job->start = {};
  job->encode_memory.reset();
  (void)free_jobs_.put(std::move(job));
}

void Server::give_up(const FrameKey& key, const std::string& why) {
  table_.on_frame_abandoned(key);
  if (std::has_single_bit(++telemetry_.frames_failed))
    base::log_warning(
        base::concat("frame not made: ", why, "; ", telemetry_.frames_failed, " so far"));
}

void Server::encode_loop() {
  while (auto job = next_of(rendered_)) {
    auto encoded = within_memory([&] { return encode_stage_.encode(**job); });
    finish_encoding(**job, std::move(encoded));
    may_start_.notify_one();
    give_back(std::move(*job));
  }
}

void Server::finish_encoding(const FrameJob& job, Result<net::EncodedFrame> encoded) {
  const FrameKey key = job.start.key;
  std::lock_guard lock(mutex_);
  encoding_ = false;
  if (!encoded) return give_up(key, encoded.error().message());
  ++telemetry_.frames_encoded;
  push_recent(telemetry_.recent, stage_times(job));
  if (parts_.log) parts_.log->add(job);
  if (!table_.expects(key)) return;
  outbox_.emplace(key, std::move(*encoded));
  carry_out(table_.on_frame_ready(key, now(), job.encoded));
}

void Server::carry_out(Actions actions) {
  for (Action& action : actions)
    std::visit([this](auto& specific) { act(std::move(specific)); }, action);
}

void Server::act(SendWelcome&& action) {
  base::log_info(base::concat("client welcomed, session ", std::hex, action.welcome.session));
  parts_.endpoint->send(action.peer, std::move(action.welcome));
}

void Server::act(SendRefusal&& action) {
  base::log_info("client refused: " + action.refusal.text);
  parts_.endpoint->send(action.peer, std::move(action.refusal));
}

void Server::act(SendBye&& action) {
  parts_.endpoint->send(action.peer, std::move(action.bye));
}

void Server::act(ReleaseFrame&& action) {
  auto node = outbox_.extract(action.key);
  MACULA_CHECK(!node.empty(), "only encoded frames are released");
  parts_.endpoint->send_frame(action.peer, std::move(node.mapped()));
}

void Server::act(AbandonFrames&& action) {
  const auto is_useless = [&](const FrameKey& key) {
    return key.session == action.session && key.epoch == action.epoch;
  };
  std::erase_if(outbox_, [&](const auto& entry) { return is_useless(entry.first); });
  if (rendering_ && is_useless(rendering_->key)) rendering_->stop.request_stop();
}

void Server::act(DropSession&& action) {
  memories_.erase(action.session);
  base::log_info(base::concat("session ", std::hex, action.session, " ended: ", action.reason));
}

Telemetry Server::telemetry() const {
  std::lock_guard lock(mutex_);
  Telemetry copy = telemetry_;
  for (const auto& [id, session] : table_.sessions())
    copy.now.push_back({id, session.epoch(), session.credit().in_flight(),
                        session.credit().unsent(), session.credit().window(now()),
                        session.link().bytes_per_s().value_or(0.0)});
  copy.sessions = table_.totals();
  copy.table = table_.counters();
  copy.net = parts_.endpoint->counters();
  return copy;
}

}  // namespace macula::session
