#include "shared/base/big_vector.h"

#include <algorithm>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace macula::base {
namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;

std::size_t rounded_up(std::size_t bytes, std::size_t alignment) {
  return (bytes + alignment - 1) / alignment * alignment;
}

}  // namespace

void* allocate_big(std::size_t bytes, std::size_t alignment) {
  alignment = std::max(bytes >= kPage ? kPage : alignment, alignof(std::max_align_t));
  const std::size_t size = rounded_up(std::max<std::size_t>(bytes, 1), alignment);
  void* memory = std::aligned_alloc(alignment, size);
  if (memory == nullptr) throw std::bad_alloc();  // as std::allocator would
#ifdef __linux__
  if (bytes >= kPage) madvise(memory, size, MADV_HUGEPAGE);  // advice: refusing it costs only time
#endif
  return memory;
}

void free_big(void* memory) {
  std::free(memory);
}

}  // namespace macula::base
