#include "server/cluster/mpi/mpi_ranks.h"

#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <climits>
#include <mutex>
#include <thread>
#include <vector>

#include "shared/base/check.h"
#include "shared/base/text.h"

namespace macula::cluster {
namespace {

using Clock = std::chrono::steady_clock;
using scheduling::Bytes;
using scheduling::Mail;
constexpr int kMailTag = 1, kStopTag = 2, kBeatTag = 3;

int count_of(std::size_t bytes) {
  MACULA_CHECK(bytes <= INT_MAX, "MPI counts bytes in an int");
  return static_cast<int>(bytes);
}

/// Looks often at first, since ranks finish together, then ever more rarely.
class Pause {
 public:
  explicit Pause(Clock::duration eager) : eager_(eager) {}
  void operator()() {
    constexpr std::chrono::microseconds kNap{50}, kLongNap{200}, kIdle{20'000};
    const auto waited = Clock::now() - begin_;
    if (waited < eager_) {
      sched_yield();
    } else {
      std::this_thread::sleep_for(waited < kIdle ? kNap : kLongNap);
    }
  }
  Clock::duration waited() const { return Clock::now() - begin_; }

 private:
  Clock::duration eager_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

struct MpiRanks::Group {
  MPI_Comm comm = MPI_COMM_NULL;
  int rank = 0, size = 1;
  std::chrono::milliseconds patience{5000};
  std::vector<std::string> hosts;
  bool is_crowded = false;        ///< more ranks here than processors
  MPI_Win window = MPI_WIN_NULL;  ///< two counters of rank 0; none until tickets are drawn
  std::uint64_t series = 0;
  std::uint64_t meetings = 0;  ///< of all ranks, this one included
  std::uint64_t all_met = 0;   ///< the last at which each had a message from each
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
    const auto here = std::ranges::count(hosts, hosts[static_cast<std::size_t>(rank)]);
    is_crowded = here > static_cast<std::ptrdiff_t>(std::thread::hardware_concurrency());
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

  /// Looks until done() says so; false after this rank's patience. Who waits for long tells rank 0
  /// where.
  template <class Done>
  bool wait_until(const Done& done) const {
    // In a frame a nap and waking up would cost more than most waits.
    constexpr std::chrono::microseconds kAlone{3000}, kCrowded{100};
    Pause pause(is_crowded ? kCrowded : kAlone);
    auto next_beat = patience / 4;
    while (!done()) {
      if (pause.waited() > patience_here()) return false;
      if (rank != 0 && pause.waited() > next_beat) {
        MPI_Send(&meetings, 1, MPI_UINT64_T, 0, kBeatTag, comm);
        next_beat += patience / 4;
      }
      pause();
    }
    return true;
  }
  static bool is_done(MPI_Request& request) {
    int done = 0;
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    return done != 0;
  }
  bool wait(MPI_Request request) {
    return wait_until([&] { return is_done(request); }) || lose(silent());
  }
  /// However long it takes; sleeps more than it looks.
  static void wait_idly(MPI_Request request) {
    constexpr std::chrono::microseconds kEager{300};
    for (Pause pause(kEager); !is_done(request);) pause();
  }

  /// The first that waits for nobody: neither at this meeting nor at one since all had a message
  /// from each, where ranks may still be.
  std::string silent() const {
    for (int other = 1; rank == 0 && other < size; ++other) {
      bool waits = false;
      for (int more = 1; more != 0;) {
        MPI_Iprobe(other, kBeatTag, comm, &more, MPI_STATUS_IGNORE);
        std::uint64_t where = 0;
        if (more == 0) break;
        MPI_Recv(&where, 1, MPI_UINT64_T, other, kBeatTag, comm, MPI_STATUS_IGNORE);
        waits = waits || where > all_met;
      }
      if (!waits) return name_of(other);
    }
    return rank == 0 ? "a rank" : name_of(0);
  }
};

namespace {

/// A meeting's messages under way. A message's length is known when it is there.
class Delivery {
 public:
  Delivery(Mail& mail, int rank, MPI_Comm comm) : mail_(mail), comm_(comm) {
    const auto ranks = static_cast<int>(mail.to.size());
    for (int step = 1; step < ranks; ++step) {  // not all to the same rank first
      const int other = (rank + step) % ranks;
      send(other);
      if (mail.comes[static_cast<std::size_t>(other)]) awaited_.push_back(other);
    }
  }
  bool is_done() {
    std::erase_if(awaited_, [&](int other) { return receive(other); });
    int done = 0;
    MPI_Testall(static_cast<int>(requests_.size()), requests_.data(), &done, MPI_STATUSES_IGNORE);
    return done != 0 && awaited_.empty();
  }

 private:
  void send(int other) {
    const auto& message = mail_.to[static_cast<std::size_t>(other)];
    if (!message) return;
    MPI_Isend(message->data(), count_of(message->size()), MPI_BYTE, other, kMailTag, comm_,
              &requests_.emplace_back());
  }
  /// False: it has not come yet.
  bool receive(int other) {
    int came = 0, count = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(other, kMailTag, comm_, &came, &message, &status);
    if (came == 0) return false;
    MPI_Get_count(&status, MPI_BYTE, &count);
    Bytes& bytes = mail_.from[static_cast<std::size_t>(other)];
    bytes.clear();  // or growing would copy what is old
    bytes.resize(static_cast<std::size_t>(count));
    MPI_Imrecv(bytes.data(), count, MPI_BYTE, &message, &requests_.emplace_back());
    return true;
  }

  Mail& mail_;
  MPI_Comm comm_;
  std::vector<MPI_Request> requests_;
  std::vector<int> awaited_;
};

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

bool MpiRanks::trade(Mail& mail) {
  if (group_->is_lost()) return false;
  ++group_->meetings;
  Delivery delivery(mail, group_->rank, group_->comm);
  if (!group_->wait_until([&] { return delivery.is_done(); }))
    return group_->lose(group_->silent());
  const auto others = std::ranges::count(mail.comes, true);
  if (others == group_->size - 1) group_->all_met = group_->meetings;
  return true;
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
    Group::wait_idly(request);
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
