// Lanes that wait to be marched, in pages that are marched where they lie. Inside server/sdf.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "server/sdf/march.h"

namespace macula::sdf {

/// Pages in no queue.
class PagePool {
 public:
  Chunk* take() {
    if (free_.empty()) {
      all_.push_back(std::make_unique<Chunk>());
      return all_.back().get();
    }
    Chunk* page = free_.back();
    free_.pop_back();
    return page;
  }
  void give(Chunk* page) { free_.push_back(page); }

 private:
  std::vector<std::unique_ptr<Chunk>> all_;
  std::vector<Chunk*> free_;
};

struct Page {
  Chunk* lanes = nullptr;
  std::size_t count = 0;
};

class LaneQueue {
 public:
  bool empty() const { return pages_.empty(); }
  std::size_t size() const { return empty() ? 0 : (pages_.size() - 1) * kBatch + last_; }
  /// A lane that nothing is known of yet but that everything before `at` is free.
  void push(const Vec3& direction, float at, float width, float half, std::uint32_t id,
            PagePool& pool) {
    Chunk& c = room(pool);
    const std::size_t i = last_++;
    c.x[i] = direction.x, c.y[i] = direction.y, c.z[i] = direction.z;
    c.width[i] = width, c.half[i] = half;
    c.id[i] = id;
    start(c, i, at);
  }
  /// Such lanes without a half-angle, with consecutive ids, from planes of directions and widths.
  void push(const float* x, const float* y, const float* z, const float* width, std::size_t count,
            float at, std::uint32_t id, PagePool& pool) {
    for (std::size_t done = 0; done < count;) {
      Chunk& c = room(pool);
      const std::size_t i = last_, part = std::min(count - done, kBatch - last_);
      for (std::size_t j = 0; j < part; ++j) {
        c.x[i + j] = x[done + j], c.y[i + j] = y[done + j], c.z[i + j] = z[done + j];
        c.width[i + j] = width[done + j], c.half[i + j] = 0.0F;
        c.id[i + j] = id + static_cast<std::uint32_t>(done + j);
        start(c, i + j, at);
      }
      last_ += part, done += part;
    }
  }
  /// Lane j of a page goes on waiting here.
  void push(const Chunk& from, std::size_t j, PagePool& pool) {
    Chunk& c = room(pool);
    const std::size_t i = last_++;
    c.x[i] = from.x[j], c.y[i] = from.y[j], c.z[i] = from.z[j];
    c.at[i] = from.at[j], c.t[i] = from.t[j];
    c.radius[i] = from.radius[j], c.first[i] = from.first[j], c.slope[i] = from.slope[j];
    c.width[i] = from.width[j], c.half[i] = from.half[j];
    c.steps[i] = from.steps[j], c.state[i] = static_cast<std::int32_t>(LaneState::Live);
    c.id[i] = from.id[j];
  }
  /// The newest page that is full, else the one that is not: lanes that are left over gather until
  /// they fill a page. The queue must not be empty. Give the page back to the pool afterwards.
  Page take() {
    if (last_ < kBatch && pages_.size() > 1) {
      const Page page{pages_[pages_.size() - 2], kBatch};
      pages_.erase(pages_.end() - 2);
      return page;
    }
    const Page page{pages_.back(), last_};
    pages_.pop_back();
    last_ = pages_.empty() ? 0 : kBatch;
    return page;
  }
  void clear(PagePool& pool) {
    while (!empty()) pool.give(take().lanes);
  }

 private:
  static void start(Chunk& c, std::size_t i, float at) {
    c.at[i] = at, c.t[i] = at;
    c.radius[i] = 0.0F, c.first[i] = at, c.slope[i] = -1.0F;
    c.steps[i] = 0, c.state[i] = static_cast<std::int32_t>(LaneState::Live);
  }
  Chunk& room(PagePool& pool) {
    if (pages_.empty() || last_ == kBatch) {
      pages_.push_back(pool.take());
      last_ = 0;
    }
    return *pages_.back();
  }

  std::vector<Chunk*> pages_;
  std::size_t last_ = 0;  ///< lanes in the last page
};

}  // namespace macula::sdf
