#include "postproc/stream/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>

#include "postproc/system/interrupt.h"
#include "postproc/system/terminal_colour.h"

namespace batten::postproc {

namespace {

constexpr std::array kStyles = {
    Choice<ProgressStyle>{ProgressStyle::kAuto, "auto", "on a terminal and under LinuxCNC"},
    Choice<ProgressStyle>{ProgressStyle::kOn, "on", "one line with the percentage"},
    Choice<ProgressStyle>{ProgressStyle::kOff, "off", "nothing"},
    Choice<ProgressStyle>{ProgressStyle::kLinuxcnc, "linuxcnc", "lines FILTER_PROGRESS=nn"},
};

ProgressStyle resolved(ProgressStyle style) {
  if (style != ProgressStyle::kAuto) return style;
  const char* axis = std::getenv("AXIS_PROGRESS_BAR");
  if (axis != nullptr && std::string_view(axis) == "1") return ProgressStyle::kLinuxcnc;
  return ::isatty(STDERR_FILENO) == 1 ? ProgressStyle::kOn : ProgressStyle::kOff;
}

// The windows of LinuxCNC look at a filter's standard error every 100 ms and read one line then:
// more lines would show what was long ago.
constexpr std::chrono::milliseconds kBetweenFilterLines{100};

// Writes each whole percentage once, never a smaller one after a greater one, and 100 always.
class Display {
 public:
  Display(ProgressStyle style, std::size_t bytes) : style_(style), bytes_(bytes) {}
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  ~Display() {
    if (style_ == ProgressStyle::kOn && shown_ >= 0) std::fputs("\r\x1b[K", stderr);
  }

  void show(double part) {
    const int percent = static_cast<int>(100 * std::clamp(part, 0.0, 1.0));
    const std::lock_guard lock(mutex_);
    if (percent <= shown_ || (percent < 100 && is_too_soon())) return;
    shown_ = percent;
    const std::string text = style_ == ProgressStyle::kLinuxcnc
                                 ? fmt::format("FILTER_PROGRESS={}\n", percent)
                                 : "\r" + progress_line(part, bytes_, seconds()) + "\x1b[K";
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  [[nodiscard]] bool is_too_soon() {
    if (style_ != ProgressStyle::kLinuxcnc) return false;
    const Clock::time_point now = Clock::now();
    if (shown_ >= 0 && now - last_line_ < kBetweenFilterLines) return true;
    last_line_ = now;
    return false;
  }

  ProgressStyle style_;
  std::size_t bytes_;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  int shown_ = -1;
  Clock::time_point last_line_;
};

}  // namespace

std::span<const Choice<ProgressStyle>> progress_styles() { return kStyles; }

std::string progress_line(double part, std::size_t bytes, double seconds) {
  // Sooner the rate says more of the start than of the work.
  constexpr double kFirstSeconds = 1;
  std::string line = fmt::format("{:3} %", static_cast<int>(100 * std::clamp(part, 0.0, 1.0)));
  if (seconds < kFirstSeconds || !(part > 0)) return line;
  line += "  " + rate_text(part * static_cast<double>(bytes) / seconds);
  if (part < 1) line += fmt::format("  about {} left", rough_time(seconds * (1 - part) / part));
  return line;
}

Progress show_progress(ProgressStyle style, std::size_t bytes) {
  const ProgressStyle shown = resolved(style);
  if (shown == ProgressStyle::kOff) return [](double) { return !interrupted(); };
  return [display = std::make_shared<Display>(shown, bytes)](double part) {
    display->show(part);
    return !interrupted();
  };
}

}  // namespace batten::postproc
