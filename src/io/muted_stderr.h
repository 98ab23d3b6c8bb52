// Libraries that print on their own, whatever they are told.
#pragma once

namespace anatomesh {

/// While it lives, what the process writes on standard error is lost.
class MutedStderr {
 public:
  MutedStderr();
  ~MutedStderr();
  MutedStderr(const MutedStderr&) = delete;
  MutedStderr& operator=(const MutedStderr&) = delete;

 private:
  int kept_ = -1;  ///< the real standard error; -1 where it could not be muted
};

}  // namespace anatomesh
