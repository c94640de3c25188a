#include "model/table/read_apart.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <exception>

namespace fogbench::model {
namespace {

constexpr std::uint64_t kMostValues = std::uint64_t{1} << 31;  // in a column
constexpr rlim_t kMostProcessorTimeS = 300;

/// One end of a pipe.
class PipeEnd {
 public:
  explicit PipeEnd(int descriptor) : descriptor_(descriptor) {}
  ~PipeEnd() { close(); }
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }

  bool write(const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t some = ::write(descriptor_, at, size);
      if (some < 0 && errno == EINTR) continue;
      if (some <= 0) return false;
      at += some;
      size -= static_cast<std::size_t>(some);
    }
    return true;
  }
  bool read(void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
      const ssize_t some = ::read(descriptor_, at, size);
      if (some < 0 && errno == EINTR) continue;
      if (some <= 0) return false;
      at += some;
      size -= static_cast<std::size_t>(some);
    }
    return true;
  }

  bool put(std::uint64_t number) { return write(&number, sizeof number); }
  bool get(std::uint64_t& number) { return read(&number, sizeof number); }
  bool put(const std::string& text) { return put(text.size()) && write(text.data(), text.size()); }
  bool get(std::string& text) {
    std::uint64_t size = 0;
    if (!get(size)) return false;
    text.resize(size);
    return read(text.data(), size);
  }

 private:
  int descriptor_;
};

void hand_over(const Result<StoredColumns>& result, PipeEnd& pipe) {
  if (!result) {
    pipe.put(std::uint64_t{0});
    pipe.put(result.error().message);
    return;
  }
  pipe.put(std::uint64_t{1});
  pipe.put(result->how);
  pipe.put(result->columns.size());
  for (const StoredColumn& column : result->columns) {
    pipe.put(column.source.name);
    pipe.put(column.source.unit);
    pipe.put(column.values.size());
    pipe.write(column.values.data(), column.values.size() * sizeof(double));
    pipe.put(column.texts.size());
    for (const std::string& text : column.texts) pipe.put(text);
  }
}

bool take_over(PipeEnd& pipe, StoredColumns& out) {
  std::uint64_t columns = 0;
  if (!pipe.get(out.how) || !pipe.get(columns)) return false;
  for (std::uint64_t i = 0; i < columns; ++i) {
    StoredColumn& column = out.columns.emplace_back();
    std::uint64_t values = 0, texts = 0;
    if (!pipe.get(column.source.name) || !pipe.get(column.source.unit)) return false;
    if (!pipe.get(values) || values > kMostValues) return false;
    column.values.resize(values);
    if (!pipe.read(column.values.data(), values * sizeof(double))) return false;
    if (!pipe.get(texts) || texts > kMostValues) return false;
    column.texts.resize(texts);
    for (std::string& text : column.texts) {
      if (!pipe.get(text)) return false;
    }
  }
  return true;
}

/// Never returns. What libraries print of their troubles is nobody's to read.
[[noreturn]] void live_as_child(const std::function<Result<StoredColumns>()>& read, PipeEnd& pipe) {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  const rlimit no_core{0, 0}, time{kMostProcessorTimeS, kMostProcessorTimeS};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
  try {
    hand_over(read(), pipe);
  } catch (const std::exception&) {  // no memory: the parent sees that nothing came
    ::_exit(1);
  }
  ::_exit(0);
}

}  // namespace

Result<StoredColumns> read_apart(const std::function<Result<StoredColumns>()>& read) {
  const auto failed = [](const char* what) { return Error{ErrorCode::kBadInput, what}; };
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) return failed("cannot be read: no pipe to a reader");
  PipeEnd from(ends[0]), to(ends[1]);
  const pid_t child = ::fork();
  if (child < 0) return failed("cannot be read: no process for a reader");
  if (child == 0) live_as_child(read, to);
  to.close();
  std::uint64_t is_good = 0;
  std::string message;
  StoredColumns columns;
  const bool came =
      from.get(is_good) && (is_good != 0 ? take_over(from, columns) : from.get(message));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!came) return failed("the file is damaged: its reader did not survive it");
  if (is_good == 0) return Error{ErrorCode::kBadInput, message};
  return columns;
}

}  // namespace fogbench::model
