#include "server/cluster/mpi/mpi_ranks.h"

#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <climits>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::cluster {
namespace {

using Clock = std::chrono::steady_clock;
using scheduling::Bytes;
using scheduling::Gathered;
constexpr int kSizeTag = 1, kStopTag = 2, kBeatTag = 3;

int count_of(std::size_t bytes) {
  MACULA_CHECK(bytes <= INT_MAX, "MPI counts bytes in an int");
  return static_cast<int>(bytes);
}

/// Looks often at first, since ranks finish together, then ever more rarely.
class Pause {
 public:
  void operator()() {
    constexpr std::chrono::microseconds kEager{300}, kNap{50}, kLongNap{200}, kIdle{20'000};
    const auto waited = Clock::now() - begin_;
    if (waited < kEager) {
      sched_yield();
    } else {
      std::this_thread::sleep_for(waited < kIdle ? kNap : kLongNap);
    }
  }
  Clock::duration waited() const { return Clock::now() - begin_; }

 private:
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

struct MpiRanks::Group {
  MPI_Comm comm = MPI_COMM_NULL;
  int rank = 0, size = 1;
  std::chrono::milliseconds patience{5000};
  std::vector<std::string> hosts;
  MPI_Win window = MPI_WIN_NULL;  ///< two counters of rank 0; none until tickets are drawn
  std::uint64_t series = 0;
  std::uint64_t meetings = 0;  ///< of all ranks, this one included
  std::uint64_t stopped = 0;   ///< the newest pass that rank 0 left
  mutable std::mutex mutex;
  std::string lost;

  void begin(MPI_Comm of, std::chrono::milliseconds wait) {
    comm = of, patience = wait;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &size);
    std::array<char, MPI_MAX_PROCESSOR_NAME> mine{};
    int length = 0;
    MPI_Get_processor_name(mine.data(), &length);
    std::vector<std::array<char, MPI_MAX_PROCESSOR_NAME>> all(static_cast<std::size_t>(size));
    MPI_Allgather(mine.data(), MPI_MAX_PROCESSOR_NAME, MPI_CHAR, all.data(), MPI_MAX_PROCESSOR_NAME,
                  MPI_CHAR, comm);
    for (const auto& name : all) hosts.emplace_back(name.data());
  }

  bool is_lost() const {
    std::lock_guard lock(mutex);
    return !lost.empty();
  }
  bool lose(const std::string& who) {
    std::lock_guard lock(mutex);
    lost = base::concat(who, " did not answer for ",
                        std::chrono::duration<double>(patience_here()).count(), " s");
    return false;
  }
  std::string name_of(int other) const {
    return base::concat("rank ", other, " of ", size, " (host ",
                        hosts[static_cast<std::size_t>(other)], ")");
  }
  std::chrono::milliseconds patience_here() const { return rank == 0 ? patience : 3 * patience; }

  /// False after `longest` (none: never). Who waits for long tells rank 0 where.
  bool wait(std::span<MPI_Request> requests, std::optional<Clock::duration> longest) const {
    Pause pause;
    auto next_beat = patience / 4;
    for (;;) {
      int done = 0;
      MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
      if (done != 0) return true;
      if (longest && pause.waited() > *longest) return false;
      if (rank != 0 && longest && pause.waited() > next_beat) {
        MPI_Send(&meetings, 1, MPI_UINT64_T, 0, kBeatTag, comm);
        next_beat += patience / 4;
      }
      pause();
    }
  }
  bool wait(MPI_Request request) {
    return wait(std::span(&request, 1), patience_here()) || lose(silent());
  }

  /// Bytes of every rank. Rank 0 hears from each by itself, and knows who is missing.
  bool tell_sizes(std::size_t mine, std::vector<std::uint64_t>& sizes) {
    sizes.assign(static_cast<std::size_t>(size), mine);
    std::vector<MPI_Request> requests;
    if (rank == 0) {
      requests.resize(static_cast<std::size_t>(size) - 1);
      for (int other = 1; other < size; ++other)
        MPI_Irecv(&sizes[static_cast<std::size_t>(other)], 1, MPI_UINT64_T, other, kSizeTag, comm,
                  &requests[static_cast<std::size_t>(other) - 1]);
    } else {
      requests.resize(1);
      MPI_Isend(&sizes[static_cast<std::size_t>(rank)], 1, MPI_UINT64_T, 0, kSizeTag, comm,
                requests.data());
    }
    if (!wait(requests, patience_here())) return lose(missing(requests));
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibcast(sizes.data(), size, MPI_UINT64_T, 0, comm, &request);
    return wait(request);
  }
  /// The first that does not wait at this meeting, too.
  std::string silent() const {
    for (int other = 1; rank == 0 && other < size; ++other) {
      bool waits = false;
      for (int more = 1; more != 0;) {
        MPI_Iprobe(other, kBeatTag, comm, &more, MPI_STATUS_IGNORE);
        std::uint64_t where = 0;
        if (more == 0) break;
        MPI_Recv(&where, 1, MPI_UINT64_T, other, kBeatTag, comm, MPI_STATUS_IGNORE);
        waits = waits || where == meetings;
      }
      if (!waits) return name_of(other);
    }
    return rank == 0 ? "a rank" : name_of(0);
  }
  std::string missing(std::span<const MPI_Request> requests) const {
    if (rank != 0) return name_of(0);
    for (std::size_t i = 0; i < requests.size(); ++i) {
      // Testall frees none of them until all are done: each is asked alone.
      MPI_Request request = requests[i];
      int done = 0;
      MPI_Request_get_status(request, &done, MPI_STATUS_IGNORE);
      if (done == 0) return name_of(static_cast<int>(i) + 1);
    }
    return "a rank";
  }
};

namespace {

struct Layout {
  std::vector<int> counts, begins;
};
Layout layout_of(Gathered& all) {
  Layout layout;
  std::size_t begin = 0;
  for (std::size_t rank = 0; rank < all.ranks(); ++rank) {
    layout.counts.push_back(count_of(all.of(rank).size()));
    layout.begins.push_back(count_of(begin));
    begin += all.of(rank).size();
  }
  return layout;
}
void* start_of(Gathered& all) {
  return all.ranks() == 0 ? nullptr : all.of(0).data();
}

}  // namespace

Result<std::shared_ptr<MpiRanks>> MpiRanks::create(std::chrono::milliseconds patience) {
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS ||
      provided < MPI_THREAD_SERIALIZED)
    return base::runtime_error("MPI cannot be used by several threads in turn", "cluster",
                               "an MPI built with MPI_THREAD_SERIALIZED");
  auto group = std::make_unique<Group>();
  group->begin(MPI_COMM_WORLD, patience);
  return std::shared_ptr<MpiRanks>(new MpiRanks(std::move(group)));
}

MpiRanks::MpiRanks(std::unique_ptr<Group> group) : group_(std::move(group)) {}

MpiRanks::~MpiRanks() {
  if (group_->is_lost()) MPI_Abort(MPI_COMM_WORLD, 1);
  if (group_->window != MPI_WIN_NULL) {
    MPI_Win_unlock_all(group_->window);
    MPI_Win_free(&group_->window);
  }
  if (owns_mpi_) MPI_Finalize();
}

int MpiRanks::rank() const {
  return group_->rank;
}
int MpiRanks::size() const {
  return group_->size;
}
std::string MpiRanks::lost() const {
  std::lock_guard lock(group_->mutex);
  return group_->lost;
}

bool MpiRanks::all_gather(const Bytes& mine, Gathered& all) {
  if (group_->is_lost()) return false;
  ++group_->meetings;
  if (all.ranks() == 0) {
    std::vector<std::uint64_t> told;
    if (!group_->tell_sizes(mine.size(), told)) return false;
    all = Gathered(std::vector<std::size_t>(told.begin(), told.end()));
  }
  const Layout layout = layout_of(all);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgatherv(mine.data(), count_of(mine.size()), MPI_BYTE, start_of(all), layout.counts.data(),
                  layout.begins.data(), MPI_BYTE, group_->comm, &request);
  return group_->wait(request);
}

bool MpiRanks::gather(const Bytes& mine, Gathered& all) {
  if (group_->is_lost()) return false;
  ++group_->meetings;
  const Layout layout = layout_of(all);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Igatherv(mine.data(), count_of(mine.size()), MPI_BYTE, start_of(all), layout.counts.data(),
               layout.begins.data(), MPI_BYTE, 0, group_->comm, &request);
  return group_->wait(request);
}

bool MpiRanks::trade(const std::vector<Bytes>& to, Gathered& from) {
  if (group_->is_lost()) return false;
  ++group_->meetings;
  std::vector<std::uint64_t> sent, got(to.size());
  std::vector<std::size_t> sizes;
  for (const Bytes& part : to) sent.push_back(part.size()), sizes.push_back(part.size());
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ialltoall(sent.data(), 1, MPI_UINT64_T, got.data(), 1, MPI_UINT64_T, group_->comm, &request);
  if (!group_->wait(request)) return false;
  Gathered parts(sizes);
  for (std::size_t rank = 0; rank < to.size(); ++rank)
    std::ranges::copy(to[rank], parts.of(rank).begin());
  from = Gathered(std::vector<std::size_t>(got.begin(), got.end()));
  const Layout out = layout_of(parts), in = layout_of(from);
  MPI_Ialltoallv(start_of(parts), out.counts.data(), out.begins.data(), MPI_BYTE, start_of(from),
                 in.counts.data(), in.begins.data(), MPI_BYTE, group_->comm, &request);
  return group_->wait(request);
}

bool MpiRanks::broadcast(Bytes& bytes) {
  if (group_->is_lost()) return false;
  ++group_->meetings;
  std::uint64_t size = bytes.size();
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibcast(&size, 1, MPI_UINT64_T, 0, group_->comm, &request);
  if (group_->rank == 0) {
    if (!group_->wait(request)) return false;
  } else {
    group_->wait(std::span(&request, 1), std::nullopt);
  }
  bytes.resize(size);
  MPI_Ibcast(bytes.data(), count_of(size), MPI_BYTE, 0, group_->comm, &request);
  return group_->wait(request);
}

void MpiRanks::begin_tickets() {
  Group& group = *group_;
  if (group.is_lost()) return;
  if (group.window == MPI_WIN_NULL) {
    std::uint64_t* counters = nullptr;
    const MPI_Aint bytes = group.rank == 0 ? 2 * sizeof(std::uint64_t) : 0;
    MPI_Win_allocate(bytes, sizeof(std::uint64_t), MPI_INFO_NULL, group.comm, &counters,
                     &group.window);
    if (group.rank == 0) counters[0] = counters[1] = 0;
    MPI_Win_lock_all(0, group.window);
    MPI_Barrier(group.comm);
  }
  ++group.series;
  // All have left the series before this one, and none has begun the next, whose counter this is.
  if (group.rank != 0) return;
  const std::uint64_t zero = 0;
  MPI_Accumulate(&zero, 1, MPI_UINT64_T, 0, static_cast<MPI_Aint>((group.series + 1) % 2), 1,
                 MPI_UINT64_T, MPI_REPLACE, group.window);
  MPI_Win_flush(0, group.window);
}

std::size_t MpiRanks::take_ticket() {
  std::lock_guard lock(group_->mutex);
  const std::uint64_t one = 1;
  std::uint64_t ticket = 0;
  MPI_Fetch_and_op(&one, &ticket, MPI_UINT64_T, 0, static_cast<MPI_Aint>(group_->series % 2),
                   MPI_SUM, group_->window);
  MPI_Win_flush(0, group_->window);
  return ticket;
}

void MpiRanks::announce_stop(std::uint64_t pass) {
  std::lock_guard lock(group_->mutex);
  // Eight bytes leave at once, whoever listens.
  for (int other = 1; other < group_->size; ++other)
    MPI_Send(&pass, 1, MPI_UINT64_T, other, kStopTag, group_->comm);
}

bool MpiRanks::hears_stop(std::uint64_t pass) {
  std::lock_guard lock(group_->mutex);
  int waits = 0;
  MPI_Iprobe(0, kStopTag, group_->comm, &waits, MPI_STATUS_IGNORE);
  if (waits != 0)
    MPI_Recv(&group_->stopped, 1, MPI_UINT64_T, 0, kStopTag, group_->comm, MPI_STATUS_IGNORE);
  return group_->stopped == pass;
}

std::shared_ptr<scheduling::RankGroup> MpiRanks::first(int ranks) {
  MPI_Comm part = MPI_COMM_NULL;
  MPI_Comm_split(group_->comm, group_->rank < ranks ? 0 : MPI_UNDEFINED, group_->rank, &part);
  if (part == MPI_COMM_NULL) return nullptr;
  auto group = std::make_unique<Group>();
  group->begin(part, group_->patience);
  auto made = std::shared_ptr<MpiRanks>(new MpiRanks(std::move(group)));
  made->owns_mpi_ = false;
  return made;
}

}  // namespace macula::cluster
