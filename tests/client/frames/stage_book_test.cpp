#include "client/frames/stage_book.h"

#include <gtest/gtest.h>

#include "tests/client/frames/stamped_path.h"

namespace macula::frames {
namespace {

using test::StampedPath;

constexpr net::ClockEstimate kClock{StampedPath::kOffset, Nanoseconds{0}, Nanoseconds{0}};

net::FrameEnd frame_end(const StampedPath& path) {
  const ServerStamps s = path.server();
  net::FrameEnd end;
  end.view_received = s.view_received;
  end.render_begin = s.render_begin;
  end.render_end = s.render_end;
  end.encode_begin = s.encode_begin;
  end.encode_end = s.encode_end;
  return end;
}

/// The FrameBegin after frame `number`, which tells when that one left the send queue.
net::FrameBegin begin_after(std::uint64_t number, const StampedPath& path) {
  net::FrameBegin begin;
  begin.epoch = 5;
  begin.frame = number + 1;
  begin.previous_frame = number;
  begin.previous_send_begin = path.server().encode_end;
  begin.previous_send_end = path.server().send_end;
  return begin;
}

void show(StageBook& book, std::uint64_t number, const StampedPath& path) {
  book.note_shown({5, number}, frame_end(path), path.client(), kClock);
}

TEST(StageBook, AccountsForAFrameOnceItsSuccessorBegan) {
  const StampedPath path;
  StageBook book;
  show(book, 1, path);
  EXPECT_TRUE(book.accounts().empty());
  EXPECT_EQ(book.incomplete(), 1U);
  book.note_begin(begin_after(1, path));
  ASSERT_EQ(book.accounts().size(), 1U);
  EXPECT_EQ(book.accounts()[0].id, (FrameId{5, 1}));
  EXPECT_EQ(book.accounts()[0].times.total, path.total());
  EXPECT_EQ(book.incomplete(), 0U);
}

TEST(StageBook, DoesNotMindIfTheSuccessorBeganBeforeTheShowing) {
  const StampedPath path;
  StageBook book;
  book.note_begin(begin_after(1, path));
  show(book, 1, path);
  ASSERT_EQ(book.accounts().size(), 1U);
  EXPECT_EQ(book.accounts()[0].times[Stage::SendQueue], path.of(Stage::SendQueue));
}

TEST(StageBook, CountsAFrameWhoseSuccessorNeverCame) {
  const StampedPath path;
  StageBook book;
  show(book, 1, path);
  book.note_begin(begin_after(2, path));
  show(book, 3, path);
  EXPECT_TRUE(book.accounts().empty());
  EXPECT_EQ(book.incomplete(), 2U);
}

TEST(StageBook, KeepsTheNewestAccountsOfALongRunAndCountsAll) {
  const StampedPath path;
  StageBook book;
  constexpr std::uint64_t kFrames = StageBook::kMostAccounts + 100;
  for (std::uint64_t number = 1; number <= kFrames; ++number) {
    show(book, number, path);
    book.note_begin(begin_after(number, path));
  }
  EXPECT_EQ(book.accounted(), kFrames);
  ASSERT_EQ(book.accounts().size(), StageBook::kMostAccounts);
  EXPECT_EQ(book.accounts().front().id, (FrameId{5, 101}));
  EXPECT_EQ(book.accounts_after(kFrames - 2).size(), 2U);
  EXPECT_TRUE(book.accounts_after(kFrames).empty());
}

TEST(StageBook, WaitsForFewFramesHoweverManyNeverGotASuccessor) {
  const StampedPath path;
  StageBook book;
  for (std::uint64_t number = 1; number <= 1000; ++number) show(book, number, path);
  EXPECT_EQ(book.incomplete(), 1000U);
  book.note_begin(begin_after(1000, path));
  book.note_begin(begin_after(1, path));  // far too late
  EXPECT_EQ(book.accounts().size(), 1U);
  EXPECT_EQ(book.incomplete(), 999U);
}

TEST(StageBook, KeepsFramesOfDifferentEpochsApart) {
  const StampedPath path;
  StageBook book;
  show(book, 1, path);
  net::FrameBegin other = begin_after(1, path);
  other.epoch = 6;
  book.note_begin(other);
  EXPECT_TRUE(book.accounts().empty());
}

TEST(StageBook, TakesTheFirstFrameOfAnEpochAsSayingNothing) {
  StageBook book;
  net::FrameBegin first;
  first.epoch = 5;
  first.frame = 1;
  book.note_begin(first);
  EXPECT_TRUE(book.accounts().empty());
}

}  // namespace
}  // namespace macula::frames
