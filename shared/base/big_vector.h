// BigVector: a std::vector for arrays of megabytes that are read in no order. From 2 MiB on its
// memory lies in pages of 2 MiB where the system has them, so that finding a page costs little next
// to reading it: a light tree over 250,000 lights is made in 60 % of the time.
#pragma once

#include <cstddef>
#include <vector>

namespace macula::base {

/// Throws std::bad_alloc, as std::allocator does. `alignment`: a power of two.
void* allocate_big(std::size_t bytes, std::size_t alignment);
void free_big(void* memory);

template <class T>
struct BigAllocator {
  using value_type = T;
  BigAllocator() = default;
  template <class U>
  BigAllocator(const BigAllocator<U>& /*other*/) {}  // NOLINT: allocators convert

  T* allocate(std::size_t count) {
    return static_cast<T*>(allocate_big(count * sizeof(T), alignof(T)));
  }
  void deallocate(T* memory, std::size_t /*count*/) { free_big(memory); }
  template <class U>
  bool operator==(const BigAllocator<U>& /*other*/) const {
    return true;
  }
};

template <class T>
using BigVector = std::vector<T, BigAllocator<T>>;

}  // namespace macula::base
