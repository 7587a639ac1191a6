// SPDX-License-Identifier: MIT
//
// The settings that are choices, and which numbers are 0, known before a shader is compiled: what
// was not chosen costs nothing. On lavapipe that is most of the cost, because it runs both sides of
// every branch.
#ifndef NEPH_REALTIME_CHOICES_GLSL
#define NEPH_REALTIME_CHOICES_GLSL

#include "realtime_names.h"

#if RT_SETTING_COUNT != 86
#error "a constant and a case for each setting, please"
#endif

layout(constant_id = 7) const bool SPECIALISED = false; // else choices are read from the view

// Constant RT_CHOICE_CONSTANT + index: the choice; of a number, whether it is other than 0.
layout(constant_id = 8) const int CHOICE_0 = 0;
layout(constant_id = 9) const int CHOICE_1 = 0;
layout(constant_id = 10) const int CHOICE_2 = 0;
layout(constant_id = 11) const int CHOICE_3 = 0;
layout(constant_id = 12) const int CHOICE_4 = 0;
layout(constant_id = 13) const int CHOICE_5 = 0;
layout(constant_id = 14) const int CHOICE_6 = 0;
layout(constant_id = 15) const int CHOICE_7 = 0;
layout(constant_id = 16) const int CHOICE_8 = 0;
layout(constant_id = 17) const int CHOICE_9 = 0;
layout(constant_id = 18) const int CHOICE_10 = 0;
layout(constant_id = 19) const int CHOICE_11 = 0;
layout(constant_id = 20) const int CHOICE_12 = 0;
layout(constant_id = 21) const int CHOICE_13 = 0;
layout(constant_id = 22) const int CHOICE_14 = 0;
layout(constant_id = 23) const int CHOICE_15 = 0;
layout(constant_id = 24) const int CHOICE_16 = 0;
layout(constant_id = 25) const int CHOICE_17 = 0;
layout(constant_id = 26) const int CHOICE_18 = 0;
layout(constant_id = 27) const int CHOICE_19 = 0;
layout(constant_id = 28) const int CHOICE_20 = 0;
layout(constant_id = 29) const int CHOICE_21 = 0;
layout(constant_id = 30) const int CHOICE_22 = 0;
layout(constant_id = 31) const int CHOICE_23 = 0;
layout(constant_id = 32) const int CHOICE_24 = 0;
layout(constant_id = 33) const int CHOICE_25 = 0;
layout(constant_id = 34) const int CHOICE_26 = 0;
layout(constant_id = 35) const int CHOICE_27 = 0;
layout(constant_id = 36) const int CHOICE_28 = 0;
layout(constant_id = 37) const int CHOICE_29 = 0;
layout(constant_id = 38) const int CHOICE_30 = 0;
layout(constant_id = 39) const int CHOICE_31 = 0;
layout(constant_id = 40) const int CHOICE_32 = 0;
layout(constant_id = 41) const int CHOICE_33 = 0;
layout(constant_id = 42) const int CHOICE_34 = 0;
layout(constant_id = 43) const int CHOICE_35 = 0;
layout(constant_id = 44) const int CHOICE_36 = 0;
layout(constant_id = 45) const int CHOICE_37 = 0;
layout(constant_id = 46) const int CHOICE_38 = 0;
layout(constant_id = 47) const int CHOICE_39 = 0;
layout(constant_id = 48) const int CHOICE_40 = 0;
layout(constant_id = 49) const int CHOICE_41 = 0;
layout(constant_id = 50) const int CHOICE_42 = 0;
layout(constant_id = 51) const int CHOICE_43 = 0;
layout(constant_id = 52) const int CHOICE_44 = 0;
layout(constant_id = 53) const int CHOICE_45 = 0;
layout(constant_id = 54) const int CHOICE_46 = 0;
layout(constant_id = 55) const int CHOICE_47 = 0;
layout(constant_id = 56) const int CHOICE_48 = 0;
layout(constant_id = 57) const int CHOICE_49 = 0;
layout(constant_id = 58) const int CHOICE_50 = 0;
layout(constant_id = 59) const int CHOICE_51 = 0;
layout(constant_id = 60) const int CHOICE_52 = 0;
layout(constant_id = 61) const int CHOICE_53 = 0;
layout(constant_id = 62) const int CHOICE_54 = 0;
layout(constant_id = 63) const int CHOICE_55 = 0;
layout(constant_id = 64) const int CHOICE_56 = 0;
layout(constant_id = 65) const int CHOICE_57 = 0;
layout(constant_id = 66) const int CHOICE_58 = 0;
layout(constant_id = 67) const int CHOICE_59 = 0;
layout(constant_id = 68) const int CHOICE_60 = 0;
layout(constant_id = 69) const int CHOICE_61 = 0;
layout(constant_id = 70) const int CHOICE_62 = 0;
layout(constant_id = 71) const int CHOICE_63 = 0;
layout(constant_id = 72) const int CHOICE_64 = 0;
layout(constant_id = 73) const int CHOICE_65 = 0;
layout(constant_id = 74) const int CHOICE_66 = 0;
layout(constant_id = 75) const int CHOICE_67 = 0;
layout(constant_id = 76) const int CHOICE_68 = 0;
layout(constant_id = 77) const int CHOICE_69 = 0;
layout(constant_id = 78) const int CHOICE_70 = 0;
layout(constant_id = 79) const int CHOICE_71 = 0;
layout(constant_id = 80) const int CHOICE_72 = 0;
layout(constant_id = 81) const int CHOICE_73 = 0;
layout(constant_id = 82) const int CHOICE_74 = 0;
layout(constant_id = 83) const int CHOICE_75 = 0;
layout(constant_id = 84) const int CHOICE_76 = 0;
layout(constant_id = 85) const int CHOICE_77 = 0;
layout(constant_id = 86) const int CHOICE_78 = 0;
layout(constant_id = 87) const int CHOICE_79 = 0;
layout(constant_id = 88) const int CHOICE_80 = 0;
layout(constant_id = 89) const int CHOICE_81 = 0;
layout(constant_id = 90) const int CHOICE_82 = 0;
layout(constant_id = 91) const int CHOICE_83 = 0;
layout(constant_id = 92) const int CHOICE_84 = 0;
layout(constant_id = 93) const int CHOICE_85 = 0;

int known_choice(int index)
{
    switch (index) {
    case 0: return CHOICE_0;
    case 1: return CHOICE_1;
    case 2: return CHOICE_2;
    case 3: return CHOICE_3;
    case 4: return CHOICE_4;
    case 5: return CHOICE_5;
    case 6: return CHOICE_6;
    case 7: return CHOICE_7;
    case 8: return CHOICE_8;
    case 9: return CHOICE_9;
    case 10: return CHOICE_10;
    case 11: return CHOICE_11;
    case 12: return CHOICE_12;
    case 13: return CHOICE_13;
    case 14: return CHOICE_14;
    case 15: return CHOICE_15;
    case 16: return CHOICE_16;
    case 17: return CHOICE_17;
    case 18: return CHOICE_18;
    case 19: return CHOICE_19;
    case 20: return CHOICE_20;
    case 21: return CHOICE_21;
    case 22: return CHOICE_22;
    case 23: return CHOICE_23;
    case 24: return CHOICE_24;
    case 25: return CHOICE_25;
    case 26: return CHOICE_26;
    case 27: return CHOICE_27;
    case 28: return CHOICE_28;
    case 29: return CHOICE_29;
    case 30: return CHOICE_30;
    case 31: return CHOICE_31;
    case 32: return CHOICE_32;
    case 33: return CHOICE_33;
    case 34: return CHOICE_34;
    case 35: return CHOICE_35;
    case 36: return CHOICE_36;
    case 37: return CHOICE_37;
    case 38: return CHOICE_38;
    case 39: return CHOICE_39;
    case 40: return CHOICE_40;
    case 41: return CHOICE_41;
    case 42: return CHOICE_42;
    case 43: return CHOICE_43;
    case 44: return CHOICE_44;
    case 45: return CHOICE_45;
    case 46: return CHOICE_46;
    case 47: return CHOICE_47;
    case 48: return CHOICE_48;
    case 49: return CHOICE_49;
    case 50: return CHOICE_50;
    case 51: return CHOICE_51;
    case 52: return CHOICE_52;
    case 53: return CHOICE_53;
    case 54: return CHOICE_54;
    case 55: return CHOICE_55;
    case 56: return CHOICE_56;
    case 57: return CHOICE_57;
    case 58: return CHOICE_58;
    case 59: return CHOICE_59;
    case 60: return CHOICE_60;
    case 61: return CHOICE_61;
    case 62: return CHOICE_62;
    case 63: return CHOICE_63;
    case 64: return CHOICE_64;
    case 65: return CHOICE_65;
    case 66: return CHOICE_66;
    case 67: return CHOICE_67;
    case 68: return CHOICE_68;
    case 69: return CHOICE_69;
    case 70: return CHOICE_70;
    case 71: return CHOICE_71;
    case 72: return CHOICE_72;
    case 73: return CHOICE_73;
    case 74: return CHOICE_74;
    case 75: return CHOICE_75;
    case 76: return CHOICE_76;
    case 77: return CHOICE_77;
    case 78: return CHOICE_78;
    case 79: return CHOICE_79;
    case 80: return CHOICE_80;
    case 81: return CHOICE_81;
    case 82: return CHOICE_82;
    case 83: return CHOICE_83;
    case 84: return CHOICE_84;
    default: return CHOICE_85;
    }
}

#endif
