// What read_image.cpp and write_image.cpp share of ITK.
#pragma once

#include <itkImageIOBase.h>
#include <itkOutputWindow.h>

#include <mutex>
#include <string>
#include <vector>

namespace anatomesh {

/// While it lives, ITK reports to it and not to the terminal, and other threads wait for their turn.
class ItkSession {
 public:
  ItkSession();
  ~ItkSession();
  ItkSession(const ItkSession&) = delete;
  ItkSession& operator=(const ItkSession&) = delete;

  /// The warnings so far, one sentence each, without ITK's file names and addresses.
  std::vector<std::string> warnings() const;

 private:
  class Listener;
  std::lock_guard<std::mutex> turn_;
  itk::SmartPointer<Listener> listener_;
  itk::OutputWindow::Pointer previous_;
};

/// One object for each image format, in the order in which they are asked whether a file is theirs.
std::vector<itk::ImageIOBase::Pointer> image_formats();

/// ITK's own description of an exception, without file names and addresses.
std::string description(const itk::ExceptionObject& error);

}  // namespace anatomesh
