#pragma once
// Errors of the world (bad bytes, I/O, user input) come back as values; bugs assert. Nothing of ours throws.

#include <string>
#include <utility>
#include <variant>

namespace promenade {

/// What went wrong: one line that says file, place, what was found and what to do. No newline, no trailing full stop.
struct Error {
  std::string message;
};

/// A value or an Error.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  /// The value; calling these on an error is a bug (and throws std::bad_variant_access, which nothing catches).
  T& operator*() & { return std::get<0>(state_); }
  const T& operator*() const& { return std::get<0>(state_); }
  T&& operator*() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }

  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value.
struct Done {};
using Status = Result<Done>;

}  // namespace promenade

/// Returns the error of a Status or Result expression from the calling function; goes on when it succeeded.
#define PROMENADE_TRY(expression)                                     \
  do {                                                                \
    if (auto promenade_status = (expression); !promenade_status.ok()) \
      return ::promenade::Error{promenade_status.error()};            \
  } while (false)
