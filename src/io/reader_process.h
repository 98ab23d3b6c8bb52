// Reading in a process of its own, for libraries that crash on damaged files: what they do to their memory, how much of
// it they take and how long they search stays there.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace anatomesh {

/// One end of what joins two processes, through which they send each other messages: numbers, lists of them, texts.
class ProcessChannel {
 public:
  /// Takes the socket. The file is for messages of errors.
  ProcessChannel(const std::filesystem::path& file, int socket);
  ~ProcessChannel();
  ProcessChannel(const ProcessChannel&) = delete;
  ProcessChannel& operator=(const ProcessChannel&) = delete;

  /// Sends a vector or a string. It is lost where the other process has ended: whoever waits for an answer notices.
  template <typename List>
  void put(const List& list) {
    put_message(Kind::values, list.data(), list.size() * sizeof(typename List::value_type));
  }
  template <typename Value>
  void put_one(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    put_message(Kind::values, &value, sizeof(Value));
  }

  /// Waits for the next message. Throws what the other process sent with put_error(), and IoError where it has ended or
  /// sent something else.
  template <typename Value>
  Value get_one() {
    static_assert(std::is_trivially_copyable_v<Value>);
    Value value;
    expect(sizeof(Value));
    get_bytes(&value, sizeof(Value));
    return value;
  }
  template <typename Value>
  std::vector<Value> get_list(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<Value>);
    expect(count * sizeof(Value));
    std::vector<Value> values(count);
    get_bytes(values.data(), count * sizeof(Value));
    return values;
  }
  std::string get_text();

  /// Sends the exception that is being handled. Those that are none of the library's are lost.
  void put_error();

 private:
  enum class Kind : std::uint32_t { values, io_error, invalid_input };
  struct Head {
    Kind kind;
    std::uint64_t bytes;
  };

  void put_message(Kind kind, const void* bytes, std::size_t size);
  bool put_bytes(const void* bytes, std::size_t size);
  std::uint64_t next_size();
  std::string text_of(std::uint64_t size);
  void expect(std::size_t size);
  void get_bytes(void* bytes, std::size_t size);
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  int socket_;
};

/// A child of this process that reads a file, or the files in a folder. It ends with this object.
///
/// It is made by fork(), which takes about 1 ms, and some 30 ms more for each GiB that this process has in use. It has
/// the thread that made it and no other, so that it must not wait for others: no oneTBB, no Python. What it prints is
/// lost. Signals end it, but for SIGINT, which is meant for this process. Beside what this process has it may take
/// memory by the size of what it reads, at most half of what is free, and so it is with seconds of computing.
class ReaderProcess {
 public:
  /// The work sends what it reads, or answers questions until the channel throws. Throws IoError where no process can
  /// be made.
  ReaderProcess(const std::filesystem::path& file, const std::function<void(ProcessChannel& parent)>& work);
  ~ReaderProcess();
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  /// Throws IoError, "... is truncated or damaged", where the child crashed, took too much or too long.
  ProcessChannel& child() { return *channel_; }

 private:
  std::unique_ptr<ProcessChannel> channel_;
  pid_t child_ = -1;
};

}  // namespace anatomesh
