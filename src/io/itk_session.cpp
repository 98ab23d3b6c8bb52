#include "io/itk_session.h"

#include <itkGDCMImageIO.h>
#include <itkMINCImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include "io/bare_sentence.h"

namespace anatomesh {
namespace {

std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

class ItkSession::Listener : public itk::OutputWindow {
 public:
  using Self = Listener;
  using Pointer = itk::SmartPointer<Self>;
  static Pointer New() {
    Pointer listener = new Self;
    listener->UnRegister();  // born with one reference
    return listener;
  }

  void DisplayText(const char*) override {}
  void DisplayErrorText(const char*) override {}
  void DisplayDebugText(const char*) override {}
  void DisplayWarningText(const char* text) override { warnings_.push_back(bare_sentence(text)); }
  void DisplayGenericOutputText(const char*) override {}

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::vector<std::string> warnings_;
};

ItkSession::ItkSession()
    : turn_(one_at_a_time()), listener_(Listener::New()), previous_(itk::OutputWindow::GetInstance()) {
  itk::OutputWindow::SetInstance(listener_);
}

ItkSession::~ItkSession() { itk::OutputWindow::SetInstance(previous_); }

std::vector<std::string> ItkSession::warnings() const { return listener_->warnings(); }

std::vector<itk::ImageIOBase::Pointer> image_formats() {
  return {itk::NiftiImageIO::New().GetPointer(), itk::NrrdImageIO::New().GetPointer(),
          itk::MetaImageIO::New().GetPointer(), itk::MINCImageIO::New().GetPointer(),
          itk::GDCMImageIO::New().GetPointer()};
}

std::string description(const itk::ExceptionObject& error) { return bare_sentence(error.GetDescription()); }

}  // namespace anatomesh
