// Bytes: what travels between ranks. Room for new bytes is not zeroed: all of it is written.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace macula::scheduling {

/// An allocator whose vectors leave new elements as the memory holds them.
template <class T>
struct Unset : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Unset<U>;
  };
  using std::allocator<T>::allocator;

  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) {
      ::new (static_cast<void*>(at)) U;
    } else {
      ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
    }
  }
};

using Bytes = std::vector<std::byte, Unset<std::byte>>;

}  // namespace macula::scheduling
