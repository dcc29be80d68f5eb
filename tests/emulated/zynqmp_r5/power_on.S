// What a boot loader does, for an emulator without one: on the first application core, by PSCI calls, starts the second
// core of the RPU with the world's image, if `world_entry` says where one is, and then, when that is ready, the first
// core at address 0.
        .equ    ready, 0xFFFC0000        // on-chip memory
        .equ    world_entry, 0xFFFC0004
        .global _start
_start: ldr     x9, =ready
        ldr     x10, =world_entry
        ldr     w2, [x10]
        cbz     w2, 2f
        mov     x1, #5                   // MPIDR of the RPU's second core
        mov     x3, #0
        ldr     x0, =0x84000003          // CPU_ON
        smc     #0
1:      yield
        ldr     w0, [x9]
        cbz     w0, 1b
2:      mov     x1, #4
        mov     x2, #0
        mov     x3, #0
        ldr     x0, =0x84000003
        smc     #0
3:      wfi
        b       3b
