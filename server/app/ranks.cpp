#include "server/app/ranks.h"

#include <algorithm>
#include <iterator>

#include "shared/base/text.h"

namespace macula::server_app {
namespace {

using scheduling::Parcel;

/// What a rank tells the others before the first frame.
struct Report {
  std::vector<char> error, what;
  base::ErrorKind kind = base::ErrorKind::BadInput;

  void carry(Parcel& parcel) { parcel.vector(error), parcel.vector(what), parcel.value(kind); }
};

std::vector<char> letters(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string first_difference(const std::vector<char>& a, const std::vector<char>& b) {
  const auto [at, other] = std::ranges::mismatch(a, b);
  const auto line = [](const std::vector<char>& text, std::vector<char>::const_iterator place) {
    const auto reverse = std::find(std::make_reverse_iterator(place), text.rend(), '\n');
    return std::string(reverse.base(), std::find(place, text.end(), '\n'));
  };
  return base::concat("'", line(b, other), "' where rank 0 has '", line(a, at), "'");
}

}  // namespace

Result<Ranks> join_ranks(const Options& options, const Environment& environment) {
  if (!environment.launched_by_mpi) return Ranks{};
  return cluster::MpiRanks::create(std::chrono::milliseconds{options.rank_timeout_ms});
}

Result<void> agree(cluster::MpiRanks& ranks, const Result<void>& mine, const std::string& what) {
  Report report{mine ? std::vector<char>{} : letters(mine.error().message()), letters(what),
                mine ? base::ErrorKind::BadInput : mine.error().kind};
  scheduling::Bytes bytes;
  Parcel packing = Parcel::packing(bytes);
  report.carry(packing);
  std::vector<scheduling::Bytes> all;
  if (!ranks.all_gather(bytes, all)) return base::runtime_error(ranks.lost(), "cluster");
  std::vector<Report> reports(all.size());
  for (std::size_t rank = 0; rank < reports.size(); ++rank) {
    Parcel parcel = Parcel::unpacking(all[rank]);
    reports[rank].carry(parcel);
  }
  const auto fail = [&](std::string text, std::string remedy, base::ErrorKind kind) {
    if (ranks.rank() != 0) text.clear(), remedy.clear();
    return tl::unexpected(Error{std::move(text), {}, std::move(remedy), kind});
  };
  for (std::size_t rank = 0; rank < reports.size(); ++rank) {
    const Report& of = reports[rank];
    if (of.error.empty()) continue;
    const std::string text(of.error.begin(), of.error.end());
    return fail(rank == 0 ? text : base::concat("rank ", rank, ": ", text), {}, of.kind);
  }
  for (std::size_t rank = 1; rank < reports.size(); ++rank) {
    if (reports[rank].what == reports[0].what) continue;
    return fail(
        base::concat("rank ", rank, " has ", first_difference(reports[0].what, reports[rank].what)),
        "give all ranks the same files, options and program", base::ErrorKind::BadInput);
  }
  return {};
}

KernelList shared_by_ranks(const KernelList& kernels,
                           const std::shared_ptr<cluster::Leader>& leader) {
  KernelList shared;
  for (std::uint32_t i = 0; i < kernels.size(); ++i)
    shared.push_back(std::make_shared<cluster::RankedKernel>(kernels[i], i, leader));
  return shared;
}

scheduling::Balance balance_of(const Options& options) {
  const auto name = std::ranges::find(scheduling::kBalanceNames, options.balance);
  return static_cast<scheduling::Balance>(name - std::begin(scheduling::kBalanceNames));
}

}  // namespace macula::server_app
