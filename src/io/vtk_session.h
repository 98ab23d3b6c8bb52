// What read_mesh.cpp and write_mesh.cpp share of VTK.
#pragma once

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <mutex>
#include <string>

namespace anatomesh {

/// While it lives, VTK reports to it and not to the terminal, and other threads wait for their turn.
class VtkSession {
 public:
  VtkSession();
  ~VtkSession();
  VtkSession(const VtkSession&) = delete;
  VtkSession& operator=(const VtkSession&) = delete;

  /// The first error so far, without VTK's file names and addresses; empty if there was none.
  std::string first_error() const;

 private:
  class Listener;
  std::lock_guard<std::mutex> turn_;
  vtkSmartPointer<Listener> listener_;
  vtkSmartPointer<vtkOutputWindow> previous_;
  vtkLogger::Verbosity previous_verbosity_;
};

}  // namespace anatomesh
