#include "io/reader_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <thread>

#include "anatomesh/errors.h"
#include "io/io_fixture.h"

namespace anatomesh::testing {
namespace {

using Work = std::function<void(ProcessChannel&)>;

class Reader : public IoTest {
 protected:
  /// The message of the exception with which a reader answers.
  template <typename Expected>
  std::string refused(const Work& work) const {
    return message_of<Expected>("scan.h5", [&] { ReaderProcess(in_folder("scan.h5"), work).child().get_text(); });
  }
};

TEST_F(Reader, SendsWhatItReads) {
  std::vector<int> numbers(1000000);
  std::iota(numbers.begin(), numbers.end(), 0);
  ReaderProcess reader(in_folder("scan.h5"), [&](ProcessChannel& parent) {
    parent.put_one(3.5);
    parent.put(numbers);
    parent.put(std::string());
    parent.put(std::string("Große Vene"));
  });
  EXPECT_EQ(reader.child().get_one<double>(), 3.5);
  EXPECT_EQ(reader.child().get_list<int>(numbers.size()), numbers);
  EXPECT_EQ(reader.child().get_text(), "");
  EXPECT_EQ(reader.child().get_text(), "Große Vene");
  EXPECT_THROW(reader.child().get_text(), IoError);  // it has no more to say
}

TEST_F(Reader, AnswersQuestions) {
  ReaderProcess reader(in_folder("scan.h5"), [](ProcessChannel& parent) {
    for (;;) parent.put_one(2 * parent.get_one<int>());
  });
  for (const int n : {1, 2, 3}) {
    reader.child().put_one(n);
    EXPECT_EQ(reader.child().get_one<int>(), 2 * n);
  }
}

TEST_F(Reader, PassesErrorsOn) {
  EXPECT_EQ(refused<IoError>([](ProcessChannel&) { throw IoError("'scan.h5' is cut"); }), "'scan.h5' is cut");
  EXPECT_EQ(refused<InvalidInput>([](ProcessChannel&) { throw InvalidInput("'scan.h5' is flat"); }),
            "'scan.h5' is flat");
}

TEST_F(Reader, CrashesAreErrors) {
  const std::vector<Work> crashes = {
      [](ProcessChannel&) { std::raise(SIGSEGV); },
      [](ProcessChannel&) { std::abort(); },
      [](ProcessChannel&) { std::raise(SIGKILL); },
      [](ProcessChannel&) { std::exit(0); },
      [](ProcessChannel&) { throw 1; },
      [](ProcessChannel& parent) { parent.put(std::string(std::size_t{2} << 20, 'x')); },
      [](ProcessChannel&) { std::vector<char>(std::size_t{1} << 36).back() = 1; },
  };
  for (const Work& crash : crashes) EXPECT_SAYS(refused<IoError>(crash), "is truncated or damaged");
}

TEST_F(Reader, EndlessSearchesEnd) {
  EXPECT_SAYS(refused<IoError>([](ProcessChannel&) {
                for (std::atomic<int> n = 0;; ++n) {
                }
              }),
              "is truncated or damaged");
}

TEST_F(Reader, PrintsNothing) {
  EXPECT_EQ(refused<IoError>([](ProcessChannel&) {
              std::puts("noise");
              std::fputs("noise", stderr);
              throw IoError("'scan.h5'");
            }),
            "'scan.h5'");
}

TEST_F(Reader, EndsWithItsObject) {
  {
    const ReaderProcess waits(in_folder("scan.h5"), [](ProcessChannel&) { ::pause(); });
  }
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);  // there is no child
}

TEST_F(Reader, ManyAtOnce) {
  const auto read_often = [this] {
    for (int n = 0; n < 50; ++n) {
      const std::vector<int> numbers(1000, n);
      ReaderProcess reader(in_folder("scan.h5"), [&](ProcessChannel& parent) {
        parent.put(std::vector<int>(numbers));
        throw IoError("'scan.h5' is cut");
      });
      EXPECT_EQ(reader.child().get_list<int>(numbers.size()), numbers);
      EXPECT_THROW(reader.child().get_text(), IoError);
    }
  };
  std::vector<std::jthread> threads;
  for (int n = 0; n < 4; ++n) threads.emplace_back(read_often);
}

TEST_F(Reader, WorksWhereChildrenAreIgnored) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(
      ReaderProcess(in_folder("scan.h5"), [](ProcessChannel& parent) { parent.put_one(7); }).child().get_one<int>(), 7);
  EXPECT_SAYS(refused<IoError>([](ProcessChannel&) { std::abort(); }), "is truncated or damaged");
  std::signal(SIGCHLD, before);
}

}  // namespace
}  // namespace anatomesh::testing
