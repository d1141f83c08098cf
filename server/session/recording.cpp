#include "server/session/recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <map>
#include <type_traits>

#include "server/session/encode_stage.h"
#include "server/session/render_stage.h"
#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/math/hash.h"
#include "shared/net/wire.h"

namespace macula::session {
namespace {

constexpr const char* kHeader = "macula-recording 3\n";
constexpr std::uint32_t kMostBlockBytes = 1U << 20;

/// Numbers one after another, as they lie in memory (little-endian machines only, like Macula).
class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const char*>(&value);
    block_.append(bytes, sizeof value);
  }
  void put_text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    block_ += text;
  }
  const std::string& block() const { return block_; }

 private:
  std::string block_;
};

/// Past the end everything reads as zero, and complete() is false.
class Reader {
 public:
  explicit Reader(std::string_view block) : block_(block) {}
  template <class T>
  T take() {
    T value{};
    if (block_.size() < sizeof value) {
      complete_ = false;
      return value;
    }
    std::memcpy(&value, block_.data(), sizeof value);
    block_.remove_prefix(sizeof value);
    return value;
  }
  std::string_view take_text() {
    const auto size = take<std::uint32_t>();
    if (size > block_.size()) {
      complete_ = false;
      return {};
    }
    const std::string_view text = block_.substr(0, size);
    block_.remove_prefix(size);
    return text;
  }
  bool complete() const { return complete_ && block_.empty(); }

 private:
  std::string_view block_;
  bool complete_ = true;
};

void put_gaze(const Gaze& gaze, Writer& out) {
  for (int axis = 0; axis < 3; ++axis) out.put(gaze.direction[axis]);
  out.put(static_cast<std::uint8_t>(gaze.valid));
  out.put(gaze.confidence);
}
Gaze take_gaze(Reader& in) {
  Gaze gaze;
  for (int axis = 0; axis < 3; ++axis) gaze.direction[axis] = in.take<float>();
  gaze.valid = in.take<std::uint8_t>() != 0;
  gaze.confidence = in.take<float>();
  return gaze;
}

void put_quality(const Quality& quality, Writer& out) {
  out.put(quality.scale);
  out.put(static_cast<std::uint64_t>(quality.bytes.color_bytes));
  out.put(static_cast<std::int32_t>(quality.bytes.depth_divisor));
  out.put(static_cast<std::uint8_t>(quality.color));
  out.put(quality.step);
}
Quality take_quality(Reader& in) {
  Quality quality;
  quality.scale = in.take<double>();
  quality.bytes.color_bytes = in.take<std::uint64_t>();
  quality.bytes.depth_divisor = in.take<std::int32_t>();
  quality.color = static_cast<Quality::Color>(in.take<std::uint8_t>());
  quality.step = in.take<std::uint32_t>();
  return quality;
}

/// What the client announced, as it would say it.
net::Hello hello_of(const ClientSetup& setup) {
  net::Hello hello;
  hello.eyes = setup.eyes;
  hello.refresh_hz = setup.refresh_hz;
  hello.settings = setup.settings;
  if (setup.takes_hidden_layer) hello.abilities = {net::kHiddenLayerAbility};
  return hello;
}

std::string block_of(const FrameJob& job) {
  const StartFrame& start = job.start;
  Writer out;
  out.put(start.key.session);
  out.put(start.key.epoch);
  out.put(start.key.frame);
  out.put_text(net::encode_envelope(hello_of(*start.setup)));
  out.put_text(net::encode_envelope(start.view));
  out.put(start.view_received.time_since_epoch().count());
  out.put(job.render_begin.time_since_epoch().count());
  out.put(start.horizon.count());
  out.put(start.guard_band.value());
  out.put(start.view_cell_m);
  out.put(static_cast<std::uint32_t>(start.gazes.size()));
  for (const FollowedGaze& gaze : start.gazes) {
    put_gaze(gaze.gaze, out);
    put_gaze(gaze.centre, out);
    out.put(gaze.radius.value());
    out.put(static_cast<std::uint8_t>(gaze.phase));
  }
  put_quality(start.quality, out);
  out.put(static_cast<std::uint8_t>(start.is_key_wanted));
  out.put(job.scene_time.since_start.count());
  out.put(static_cast<std::uint8_t>(job.starts_history));
  return out.block();
}

/// A message of the wire inside a block.
template <class Kind>
std::optional<Kind> take_message(Reader& in) {
  const std::string_view text = in.take_text();
  auto message = net::decode_envelope(std::as_bytes(std::span(text.data(), text.size())), {});
  if (!message || !std::holds_alternative<Kind>(*message)) return std::nullopt;
  return std::get<Kind>(std::move(*message));
}

/// What a renderer may be asked; a file may say anything.
bool is_sane(const StartFrame& start) {
  const auto is_unit = [](const Gaze& gaze) {
    return math::is_finite(gaze.direction) && std::abs(glm::length(gaze.direction) - 1.0F) < 1e-3F;
  };
  const bool gazes = std::all_of(start.gazes.begin(), start.gazes.end(), [&](const auto& gaze) {
    const double radius = gaze.radius.value();
    return is_unit(gaze.gaze) && is_unit(gaze.centre) && radius >= 0.0 && radius <= 180.0;
  });
  const double scale = start.quality.scale, guard = start.guard_band.value();
  return gazes && net::check_view_state(start.view) && scale > 0.0 && scale <= 1.0 &&
         guard >= 0.0 && guard <= 90.0 && start.view_cell_m >= 0.0 && start.view_cell_m <= 1.0;
}

std::optional<RecordedFrame> frame_of(std::string_view block) {
  constexpr std::uint32_t kMostEyes = 2;
  Reader in(block);
  RecordedFrame frame;
  StartFrame& start = frame.start;
  start.key.session = in.take<std::uint64_t>();
  start.key.epoch = in.take<std::uint32_t>();
  start.key.frame = in.take<std::uint64_t>();
  auto hello = take_message<net::Hello>(in);
  auto view = take_message<net::ViewState>(in);
  if (!hello || !view || hello->eyes.size() != view->eyes.size()) return std::nullopt;
  hello->codecs = {hello->settings.color_codec};
  const auto setup = check_hello(*hello, {});
  if (!setup) return std::nullopt;
  start.setup = std::make_shared<const ClientSetup>(*setup);
  start.view = std::move(*view);
  start.view_received = ServerTime{Nanoseconds{in.take<Nanoseconds::rep>()}};
  in.take<Nanoseconds::rep>();  // when it began, for people who read the file
  start.horizon = Nanoseconds{in.take<Nanoseconds::rep>()};
  start.guard_band = Degrees{in.take<double>()};
  start.view_cell_m = in.take<double>();
  const auto gazes = in.take<std::uint32_t>();
  for (std::uint32_t eye = 0; eye < std::min(gazes, kMostEyes); ++eye) {
    FollowedGaze gaze;
    gaze.gaze = take_gaze(in);
    gaze.centre = take_gaze(in);
    gaze.radius = Degrees{in.take<double>()};
    gaze.phase = static_cast<foveation::GazePhase>(in.take<std::uint8_t>());
    start.gazes.push_back(gaze);
  }
  start.quality = take_quality(in);
  start.is_key_wanted = in.take<std::uint8_t>() != 0;
  start.scene_time = kernels::SceneTime{Nanoseconds{in.take<Nanoseconds::rep>()}};
  frame.starts_history = in.take<std::uint8_t>() != 0;
  const bool is_good = in.complete() && is_sane(start);
  return is_good ? std::optional(std::move(frame)) : std::nullopt;
}

/// The blocks of a file, whole ones only.
std::vector<std::string_view> blocks_of(std::string_view bytes) {
  std::vector<std::string_view> blocks;
  while (bytes.size() >= sizeof(std::uint32_t)) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes.remove_prefix(sizeof size);
    if (size > kMostBlockBytes || size > bytes.size()) break;
    blocks.push_back(bytes.substr(0, size));
    bytes.remove_prefix(size);
  }
  return blocks;
}

void write_block(std::ofstream& file, const std::string& block) {
  const auto size = static_cast<std::uint32_t>(block.size());
  file.write(reinterpret_cast<const char*>(&size), sizeof size);
  file.write(block.data(), static_cast<std::streamsize>(block.size()));
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::create(const std::string& path,
                                                   const std::string& description) {
  auto recorder = std::make_unique<Recorder>();
  recorder->path_ = path;
  recorder->file_.open(path, std::ios::binary | std::ios::trunc);
  recorder->file_ << kHeader;
  write_block(recorder->file_, description);
  if (!recorder->file_)
    return base::bad_input("cannot be written", path, "a place for a recording");
  return recorder;
}

void Recorder::add(const FrameJob& job) {
  if (failed_) return;
  write_block(file_, block_of(job));
  file_.flush();
  failed_ = !file_;
  if (failed_) base::log_warning("the recording ends here, it cannot be written: " + path_);
}

Result<Recording> load_recording(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::string_view header = kHeader;
  if (!file || bytes.compare(0, header.size(), header) != 0)
    return base::bad_input("not a recording", path, "a file that macula-server --record wrote");
  const auto blocks = blocks_of(std::string_view(bytes).substr(header.size()));
  if (blocks.empty()) return base::bad_input("no description", path, "an unbroken recording");
  Recording recording;
  recording.description = blocks[0];
  for (std::size_t i = 1; i < blocks.size(); ++i) {
    auto frame = frame_of(blocks[i]);
    if (!frame) return base::bad_input("damaged", base::concat(path, ", frame ", i));
    recording.frames.push_back(std::move(*frame));
  }
  return recording;
}

std::uint64_t digest(std::span<const net::SliceEntry> slices,
                     const std::function<std::span<const std::byte>(std::size_t)>& payload) {
  std::uint64_t hash = slices.size();
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const net::SliceEntry& slice = slices[i];
    for (const std::uint64_t word :
         {std::uint64_t{slice.eye}, std::uint64_t{slice.layer},
          static_cast<std::uint64_t>(slice.codec), static_cast<std::uint64_t>(slice.rect.width),
          static_cast<std::uint64_t>(slice.rect.height), std::uint64_t{slice.size_bytes}}) {
      hash = math::hash_combine(hash, word);
    }
    for (auto bytes = payload(i); !bytes.empty();) {
      std::uint64_t word = 0;
      const std::size_t size = std::min(bytes.size(), sizeof word);
      std::memcpy(&word, bytes.data(), size);
      hash = math::hash_combine(hash, word);
      bytes = bytes.subspan(size);
    }
  }
  return hash;
}

Result<void> replay(const Recording& recording, const ServerConfig& config,
                    std::shared_ptr<kernels::SceneTimeline> scene,
                    std::shared_ptr<const kernels::Kernel> kernel, int threads,
                    const std::function<void(const ReplayedFrame&)>& frame_made) {
  const base::SteadyClock clock;
  RenderStage render(config, std::move(scene), std::move(kernel),
                     std::make_shared<scheduling::TileScheduler>(threads), clock);
  EncodeStage encode(config, clock);
  std::map<std::pair<std::uint64_t, std::uint32_t>, RenderMemory> memories;
  FrameJob job;
  for (const RecordedFrame& recorded : recording.frames) {
    const FrameKey& key = recorded.start.key;
    RenderMemory& memory = memories[{key.session, key.epoch}];
    if (recorded.starts_history) memory.history = {};
    job.start = recorded.start;
    job.encode_memory = memory.encode;
    const auto rendered = render.render(job, memory, {});
    if (!rendered) return base::forward(rendered);
    const auto encoded = encode.encode(job);
    if (!encoded) return base::forward(encoded);
    ReplayedFrame made{key, 0, 0};
    for (const net::Payload& payload : encoded->payloads) made.bytes += payload->size();
    made.digest = digest(encoded->begin.slices,
                         [&](std::size_t i) { return std::span(*encoded->payloads[i]); });
    frame_made(made);
  }
  return {};
}

}  // namespace macula::session
