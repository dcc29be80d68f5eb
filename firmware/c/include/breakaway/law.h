/* The law of one axis for programs in C and in whatever calls C: a position once a period, a force in return.
 *
 * The law is the class that C++ uses, law::AxisController, with the numbers that `breakaway design FILE --law-image OUT`
 * has certified. There is one set of functions for float, breakaway_law_f_..., and one for double, breakaway_law_d_...;
 * both take the same image. Nothing here allocates, blocks or throws, and a step takes a bounded number of instructions.
 * Laws share nothing: two may be called at the same time, from tasks or interrupts, but one only after the other call
 * of it has returned.
 *
 *   #include <breakaway/law.h>
 *   #include "axis_law.h"                     // breakaway design axis.toml --law-image axis_law.h
 *
 *   static breakaway_law_f law;               // stays where it is: it points into itself
 *   if (breakaway_law_f_init(&law, sizeof law, BREAKAWAY_LAW_ABI, breakaway_law_image, sizeof breakaway_law_image, 0)
 *       != BREAKAWAY_OK) ...
 *   breakaway_law_f_set_target(&law, 0.125F);
 *   each period:  force_N = breakaway_law_f_update(&law, position_m, fresh);
 *
 * The force is to act one period after the position was read, or as much later as [loop] latency says in the file.
 */
#ifndef BREAKAWAY_LAW_H
#define BREAKAWAY_LAW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define BREAKAWAY_PUBLIC __attribute__((visibility("default")))
#else
#define BREAKAWAY_PUBLIC
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Rises when a type or a function of this header changes so that a program has to be compiled again. */
#define BREAKAWAY_LAW_ABI 1U

/* What the functions return that can fail. Where they do, nothing has changed. */
enum breakaway_result {
  BREAKAWAY_OK = 0,
  BREAKAWAY_NULL_POINTER = 1,
  BREAKAWAY_WRONG_ABI = 2,         /* the program was compiled for another version of this header */
  BREAKAWAY_STORAGE_TOO_SMALL = 3, /* law_bytes is less than the library needs */
  BREAKAWAY_NO_LAW_IMAGE = 4,      /* these bytes are no law image, or of a version that the library does not know */
  BREAKAWAY_IMAGE_DAMAGED = 5,     /* its checksum differs */
  BREAKAWAY_NO_SUCH_AXIS = 6,
  BREAKAWAY_NOT_CERTIFIED = 7,
  BREAKAWAY_LAW_INVALID = 8,       /* a number of the law is out of its range */
  BREAKAWAY_NOT_A_NUMBER = 9,      /* the target is no finite number */
  BREAKAWAY_NOT_INITIALISED = 10
};
/* A sentence with the remedy; never null. */
BREAKAWAY_PUBLIC const char* breakaway_result_text(int result);

enum breakaway_mode {
  BREAKAWAY_APPROACH = 0, /* on its way, until it is certified at rest for the first time */
  BREAKAWAY_KICK = 1,     /* a pulse is under way */
  BREAKAWAY_COAST = 2,    /* after a pulse, not yet certified at rest */
  BREAKAWAY_HOLD = 3,     /* certified at rest, as near as the tolerance promises */
  BREAKAWAY_FAULT = 4     /* no force until breakaway_law_..._reset() */
};
/* "approach", "kick" and so on; "unknown mode" for any other number. */
BREAKAWAY_PUBLIC const char* breakaway_mode_name(int mode);
/* "none", "measurement is not a number", "axis does not move under kicks" and so on, for the fault of a status; "unknown
 * control fault" for any other number. */
BREAKAWAY_PUBLIC const char* breakaway_fault_name(int fault);

typedef struct breakaway_law_status {
  int32_t mode;           /* breakaway_mode */
  int32_t fault;          /* 0: none */
  uint32_t kicks;         /* modulo 2^32; it rises as one is decided on, with its first force or a period before */
  double target_m;
  double velocity_m_s;    /* as the law estimates it */
  double seen_friction_N; /* which contradicted the bounds, where that is the fault; 0 otherwise */
  double max_force_N;     /* of every force that update() returns */
  double period_s;        /* update() is to be called once in this time */
  double position_tolerance_m; /* BREAKAWAY_HOLD promises it, to half a count: of the file, or the floor above it */
} breakaway_law_status;

/* The bytes that the caller provides. Their content is nobody's business, but they must be zero or initialised. */
#define BREAKAWAY_LAW_F_BYTES 6144
#define BREAKAWAY_LAW_D_BYTES 12288
typedef union breakaway_law_f {
  double aligned;
  unsigned char bytes[BREAKAWAY_LAW_F_BYTES];
} breakaway_law_f;
typedef union breakaway_law_d {
  double aligned;
  unsigned char bytes[BREAKAWAY_LAW_D_BYTES];
} breakaway_law_d;

/* Makes a law of axis 0, 1, ... of the image, with its target where the axis is at position 0. law_bytes: sizeof *law;
 * abi: BREAKAWAY_LAW_ABI. The image may go afterwards; the law must not be moved. Call it again to begin anew. */
BREAKAWAY_PUBLIC int breakaway_law_f_init(breakaway_law_f* law, size_t law_bytes, unsigned abi, const void* image, size_t image_bytes,
                         unsigned axis);
BREAKAWAY_PUBLIC int breakaway_law_d_init(breakaway_law_d* law, size_t law_bytes, unsigned abi, const void* image, size_t image_bytes,
                         unsigned axis);

/* Once a period, of a law that is not null. fresh: false where no new sample came, so that position_m is not looked at;
 * a law whose samples stay away goes on without them. Returns the force in newtons: 0 from a law that was not
 * initialised. A position that is no finite number is a fault.
 * A float holds a position, and a target, to a quarter of a count within four million counts (2^22) of 0, and what is
 * certified holds so much less exactly; further away take double. */
BREAKAWAY_PUBLIC float breakaway_law_f_update(breakaway_law_f* law, float position_m, bool fresh);
BREAKAWAY_PUBLIC double breakaway_law_d_update(breakaway_law_d* law, double position_m, bool fresh);

/* From the next period on. A target that is where it was changes nothing. Any other is approached anew, or after the
 * brake or kick that is under way and leads away from it. */
BREAKAWAY_PUBLIC int breakaway_law_f_set_target(breakaway_law_f* law, float target_m);
BREAKAWAY_PUBLIC int breakaway_law_d_set_target(breakaway_law_d* law, double target_m);

/* Leaves a fault and forgets what was seen: the next update begins a new approach. */
BREAKAWAY_PUBLIC int breakaway_law_f_reset(breakaway_law_f* law);
BREAKAWAY_PUBLIC int breakaway_law_d_reset(breakaway_law_d* law);

BREAKAWAY_PUBLIC int breakaway_law_f_status(const breakaway_law_f* law, breakaway_law_status* status);
BREAKAWAY_PUBLIC int breakaway_law_d_status(const breakaway_law_d* law, breakaway_law_status* status);

#ifdef __cplusplus
}
#endif

#endif
