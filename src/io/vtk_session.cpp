#include "io/vtk_session.h"

#include <vtkObjectFactory.h>

#include "io/bare_sentence.h"

namespace anatomesh {
namespace {

std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

class VtkSession::Listener : public vtkOutputWindow {
 public:
  static Listener* New() { VTK_STANDARD_NEW_BODY(Listener); }

  void DisplayText(const char*) override {}
  void DisplayWarningText(const char*) override {}
  void DisplayGenericWarningText(const char*) override {}
  void DisplayDebugText(const char*) override {}
  void DisplayErrorText(const char* text) override {
    if (first_error_.empty()) first_error_ = bare_sentence(text);
  }

  const std::string& first_error() const { return first_error_; }

 private:
  std::string first_error_;
};

VtkSession::VtkSession()
    : turn_(one_at_a_time()),
      listener_(vtkSmartPointer<Listener>::New()),
      previous_(vtkOutputWindow::GetInstance()),
      previous_verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
  vtkOutputWindow::SetInstance(listener_);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkSession::~VtkSession() {
  vtkLogger::SetStderrVerbosity(previous_verbosity_);
  vtkOutputWindow::SetInstance(previous_);
}

std::string VtkSession::first_error() const { return listener_->first_error(); }

}  // namespace anatomesh
