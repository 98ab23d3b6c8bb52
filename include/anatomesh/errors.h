// The exceptions that the library throws. It never prints and never exits.
#pragma once

#include <stdexcept>

namespace anatomesh {

/// Base of all errors of the library; what() is one sentence that names the value at fault and what
/// would be right.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An image, mesh or option that cannot be used.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// An option outside its range (a kind of invalid input that the caller, not the data, must mend).
class InvalidOption : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// A file that cannot be read or written.
class IoError : public Error {
 public:
  using Error::Error;
};

/// The input is fine but no mesh could be made of it.
class MeshingFailed : public Error {
 public:
  using Error::Error;
};

/// The caller asked to stop.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace anatomesh
