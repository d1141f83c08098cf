// Result<T>: what a function returns when the world (a file, a peer, a setting) may be at fault.
// An Error says what went wrong, where in the input, and what is allowed. Our own bugs go through
// MACULA_CHECK instead; nothing in Macula throws.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace macula::base {

/// Decides the exit status: bad arguments or input end a program with 2, everything else with 1.
enum class ErrorKind { BadInput, Runtime };

struct Error {
  std::string what;    ///< what is wrong, one clause without a full stop
  std::string where;   ///< file, row, field or endpoint it concerns; may be empty
  std::string remedy;  ///< what is allowed or what to do; may be empty
  ErrorKind kind = ErrorKind::BadInput;

  /// "where: what (remedy)" on one line.
  std::string message() const {
    std::string text = where.empty() ? what : where + ": " + what;
    return remedy.empty() ? text : text + " (" + remedy + ")";
  }
  int exit_status() const { return kind == ErrorKind::BadInput ? 2 : 1; }
};

template <class T>
using Result = tl::expected<T, Error>;

/// `return bad_input("...", "file.gltf", "...")` from any function that returns a Result.
inline tl::unexpected<Error> bad_input(std::string what, std::string where = {},
                                       std::string remedy = {}) {
  return tl::unexpected<Error>(
      Error{std::move(what), std::move(where), std::move(remedy), ErrorKind::BadInput});
}
inline tl::unexpected<Error> runtime_error(std::string what, std::string where = {},
                                           std::string remedy = {}) {
  return tl::unexpected<Error>(
      Error{std::move(what), std::move(where), std::move(remedy), ErrorKind::Runtime});
}
/// Hands an error on: `if (!r) return forward(r);`.
template <class T>
tl::unexpected<Error> forward(const Result<T>& failed) {
  return tl::unexpected<Error>(failed.error());
}

}  // namespace macula::base

namespace macula {
using base::Error;
using base::Result;
}  // namespace macula
