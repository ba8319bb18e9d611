// Errors are values: a code with a name, and a sentence that tells the caller what to do.
// No function of the library throws across its border: where there is no memory that is ErrorCode::buffer_full, and all
// is as it was; a call that answers with a value, and a constructor, end the process with a sentence.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <variant>

namespace pcphys {

enum class ErrorCode {
  none,
  not_finite,           // a number is NaN or infinite
  bad_mass,             // a dynamic body's mass is not above zero, or its inertia is impossible
  degenerate_shape,     // a shape has no volume, or is smaller or larger than the library resolves
  not_unit_quaternion,  // an orientation is further than 1e-3 from unit length
  bad_time_step,        // dt or the number of sub-steps is not above zero
  stale_id,             // the object was destroyed, or the id never named one
  bad_joint,            // the two bodies are the same, or neither can move
  bad_argument,         // any other value outside its range
  unknown_name,         // a scene, property or option of that name does not exist
  name_taken,           // there is a property, table or kernel of that name already
  wrong_type,           // a property holds values of another type
  unavailable,          // what was asked for is not on this machine (no GL, no such lane width, no FCL)
  buffer_full,          // a fixed capacity is too small; the message says how much is needed
  device_error,         // the GL driver refused a program, a buffer or a dispatch
  bad_file,             // a file cannot be read or written, or does not hold what it should
  bad_snapshot,         // bytes that are not a snapshot of a world of this kind
  busy                  // a step of this world or stepper runs: its callbacks may look, not change
};

/// "bad_mass" and so on: the name in error messages and in JSON.
const char* name(ErrorCode code);

struct Error {
  ErrorCode code = ErrorCode::none;
  std::string message;  // a whole sentence: what was wrong and what to do
};

namespace detail {
/// What no error can answer: says the sentence on standard error and ends the process by abort().
[[noreturn]] void misuse(const char* sentence);
[[noreturn]] void no_value(const Error& error);
[[noreturn]] void no_error();
[[noreturn]] void moved_from(const char* what, const char* call);
/// Of a call that answers with a value and has no memory for it.
[[noreturn]] void no_memory_for(const char* call);
/// An error in memory of its own; where there is none for it, the one that says so,
/// which was made when the process began.
std::shared_ptr<const Error> keep(Error error) noexcept;
}  // namespace detail

/// A value, or why there is none. Taking the value where there is none, or the error where there is a value, ends the
/// process with a sentence that holds the error's.
template <class T> class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return content_.index() == 0; }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(value()); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Error& error() const {
    if (*this) detail::no_error();
    return *std::get_if<1>(&content_);
  }

 private:
  const T& value() const {
    if (!*this) detail::no_value(error());
    return *std::get_if<0>(&content_);
  }
  T& value() {
    if (!*this) detail::no_value(error());
    return *std::get_if<0>(&content_);
  }

  std::variant<T, Error> content_;
};

/// Success, or an error. Success is a null pointer: a step hands on dozens of these.
template <> class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) {
    if (error.code != ErrorCode::none) error_ = detail::keep(std::move(error));
  }

  explicit operator bool() const { return !error_; }
  const Error& error() const {
    if (!error_) detail::no_error();
    return *error_;
  }

 private:
  std::shared_ptr<const Error> error_;
};

using Status = Result<void>;

}  // namespace pcphys
