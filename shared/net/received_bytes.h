// Reading bytes that libzmq received, under ThreadSanitizer.
#pragma once

namespace macula::net {

/// While it lives, ThreadSanitizer does not check this thread's memory accesses: libzmq hands
/// received bytes to us by means the sanitizer cannot see. Only for reading a message; nothing in
/// other builds.
class ReadingReceivedBytes {
 public:
  ReadingReceivedBytes();
  ~ReadingReceivedBytes();
  ReadingReceivedBytes(const ReadingReceivedBytes&) = delete;
  ReadingReceivedBytes& operator=(const ReadingReceivedBytes&) = delete;
};

}  // namespace macula::net
