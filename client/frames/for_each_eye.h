// for_each_eye(n, work): runs work(0) .. work(n - 1) at the same time, one thread an eye, and
// returns when all are done. `work` must not touch another eye's data.
#pragma once

#include <cstddef>
#include <thread>
#include <vector>

namespace macula::frames {

template <class Work>
void for_each_eye(std::size_t eyes, const Work& work) {
  std::vector<std::jthread> others;
  for (std::size_t eye = 1; eye < eyes; ++eye) others.emplace_back([&work, eye] { work(eye); });
  if (eyes > 0) work(std::size_t{0});
}

}  // namespace macula::frames
