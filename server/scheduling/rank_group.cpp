#include "server/scheduling/rank_group.h"

namespace macula::scheduling {

Mail& RankGroup::new_mail() {
  const auto ranks = static_cast<std::size_t>(size());
  mail_.to.assign(ranks, std::nullopt);
  mail_.comes.assign(ranks, false);
  mail_.from.resize(ranks);
  mail_.written.resize(ranks);
  for (Bytes& bytes : mail_.written) bytes.clear();
  return mail_;
}

bool RankGroup::all_gather(const Bytes& mine, std::vector<Bytes>& all) {
  Mail& mail = new_mail();
  const auto own = static_cast<std::size_t>(rank());
  for (std::size_t rank = 0; rank < mail.to.size(); ++rank) {
    if (rank == own) continue;
    mail.to[rank] = mine;
    mail.comes[rank] = true;
  }
  if (!trade(mail)) return false;
  all = mail.from;
  all[own] = mine;
  return true;
}

}  // namespace macula::scheduling
