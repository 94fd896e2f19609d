"""Materials of thin sheets in Radiance's language, each named m."""

SHEETS = {
    "plastic": "void plastic m 0 0 5 .5 .4 .3 .05 .1",
    "smooth plastic": "void plastic m 0 0 5 .5 .4 .3 .05 0",
    "metal": "void metal m 0 0 5 .5 .4 .3 .8 .15",
    "smooth metal": "void metal m 0 0 5 .5 .4 .3 .8 0",
    "trans": "void trans m 0 0 7 .5 .4 .3 .1 .15 .6 .5",
    "smooth trans": "void trans m 0 0 7 .5 .4 .3 .05 0 .6 .5",
    "plastic2": "void plastic2 m 4 0 .3 1 . 0 6 .5 .4 .3 .1 .1 .3",
    "metal2": "void metal2 m 6 0 1 1 . -rz 90 0 6 .5 .4 .3 .8 .3 .15",
    "trans2": "void trans2 m 4 0 1 1 . 0 8 .5 .4 .3 .1 .1 .2 .6 .5",
    "glass": "void glass m 0 0 3 .9 .8 .7",
    "dense glass": "void glass m 0 0 4 .9 .8 .7 1.8",
    "mirror": "void mirror m 0 0 3 .9 .8 .7",
    "BRTDfunc": (
        "void BRTDfunc m 10 if(Rdot,.1,.25)+.5*(1-abs(Rdot))^5 .1 .05"
        " .6*abs(Rdot)^.3 .4*abs(Rdot)^.3 if(Rdot,.3,.2) 0 0 0 ."
        " 0 9 .05 .1 .2 .2 .1 .05 .1 .15 .2"
    ),
    "BRTDfunc without mirror": (
        "void BRTDfunc m 10 0 0 0 .6*abs(Rdot)^.3 .4*abs(Rdot)^.3 if(Rdot,.3,.2)"
        " 0 0 0 . 0 9 .05 .1 .2 .2 .1 .05 .1 .15 .2"
    ),
    "mixture": (
        "void plastic a 0 0 5 .5 .4 .3 .1 .2\n"
        "void trans b 0 0 7 .5 .4 .3 .1 .1 .6 .5\nvoid mixfunc m 4 a b .3 . 0 0"
    ),
    "perforated": (
        "void plastic a 0 0 5 .5 .4 .3 .1 .2\nvoid mixfunc m 4 a void .6 . 0 0"
    ),
}
