// A plugin of QEMU that counts the guest's instructions from each passage of one address to the next passage of
// another.
//
//   -plugin libinstruction_count.so,begin=0x...,end=0x...,out=FILE[,below=0x...]
//
// FILE gets one count a line, in order. The count is of instructions executed, exact and the same in every run; with
// `below`, of those at lower addresses, so that another processor that runs code of its own does not count.
// QEMU 7.2 ships no header for plugins; the declarations are those of its plugin interface, version 1.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

extern "C" {
struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
using qemu_plugin_id_t = std::uint64_t;
enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS, QEMU_PLUGIN_CB_R_REGS, QEMU_PLUGIN_CB_RW_REGS };
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, qemu_plugin_tb*));
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb*);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb*, std::size_t);
std::uint64_t qemu_plugin_insn_vaddr(const qemu_plugin_insn*);
void qemu_plugin_register_vcpu_insn_exec_cb(qemu_plugin_insn*, void (*)(unsigned, void*), qemu_plugin_cb_flags, void*);
void qemu_plugin_register_vcpu_insn_exec_inline(qemu_plugin_insn*, qemu_plugin_op, void*, std::uint64_t);
[[gnu::visibility("default")]] extern const int qemu_plugin_version;
const int qemu_plugin_version = 1;
}

namespace {

constexpr std::uint64_t thumb_bit = 1;

std::uint64_t executed = 0, at_begin = 0, begin_address = 0, end_address = 0, below_address = UINT64_MAX;
bool counting = false;
std::FILE* output =
    nullptr;  // flushed by exit(); nothing here may have a destructor, which would run before the last callback

void pass_begin(unsigned, void*) {
  at_begin = executed;
  counting = true;
}

void pass_end(unsigned, void*) {
  if (counting) std::fprintf(output, "%llu\n", static_cast<unsigned long long>(executed - at_begin));
  counting = false;
}

// Callbacks of one instruction run in the order of their registration, so the begin's own instruction counts, and the
// end's does not.
void instrument(qemu_plugin_id_t, qemu_plugin_tb* block) {
  for (std::size_t i = 0; i < qemu_plugin_tb_n_insns(block); ++i) {
    qemu_plugin_insn* const instruction = qemu_plugin_tb_get_insn(block, i);
    const std::uint64_t address = qemu_plugin_insn_vaddr(instruction) & ~thumb_bit;
    if (address == begin_address)
      qemu_plugin_register_vcpu_insn_exec_cb(instruction, pass_begin, QEMU_PLUGIN_CB_NO_REGS, nullptr);
    if (address == end_address)
      qemu_plugin_register_vcpu_insn_exec_cb(instruction, pass_end, QEMU_PLUGIN_CB_NO_REGS, nullptr);
    if (address < below_address)
      qemu_plugin_register_vcpu_insn_exec_inline(instruction, QEMU_PLUGIN_INLINE_ADD_U64, &executed, 1);
  }
}

bool read_argument(std::string_view argument) {
  const auto value = [&] { return std::string{argument.substr(argument.find('=') + 1)}; };
  if (argument.starts_with("begin="))
    begin_address = std::strtoull(value().c_str(), nullptr, 0) & ~thumb_bit;
  else if (argument.starts_with("end="))
    end_address = std::strtoull(value().c_str(), nullptr, 0) & ~thumb_bit;
  else if (argument.starts_with("below="))
    below_address = std::strtoull(value().c_str(), nullptr, 0);
  else if (argument.starts_with("out="))
    output = std::fopen(value().c_str(), "w");
  else
    return false;
  return true;
}

}  // namespace

extern "C" [[gnu::visibility("default")]] int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t*, int count,
                                                                  char** arguments) {
  for (int i = 0; i < count; ++i) {
    if (read_argument(arguments[i])) continue;
    std::fprintf(stderr, "instruction_count: does not know '%s'; takes begin=, end=, below=, out=\n", arguments[i]);
    return -1;
  }
  if (begin_address == 0 || end_address == 0 || output == nullptr) {
    std::fputs("instruction_count: needs begin=ADDRESS, end=ADDRESS and out=FILE, a file that can be written\n",
               stderr);
    return -1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, instrument);
  return 0;
}
