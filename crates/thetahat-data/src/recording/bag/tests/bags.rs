//! Bags that other programs wrote: rosbags 0.11.9 (Python). Each is compressed by zlib and in base64.
//!
//! Two messages at 1.7e9 s and 8 ms later. `/joint_states`: joints shoulder and elbow, positions 1 and 2, one more in the second message;
//! velocities 0.5 and 0.25; efforts 10 and 20, one more in the second. `/lowstate`: a type with every kind of field. `/dynamic`: joints with
//! interfaces of different names.

use std::io::Read;

use flate2::read::ZlibDecoder;

/// The three topics in MCAP.
pub(super) const ALL_MCAP: &str = "\
    eNrtGk1v3ETUyW7S4BIQaVElkKqhrVqpqI0/dr3eVUMDbUWLUlE1tHyEYI3t8cbg9Ww83qTpqeJWIYTgwoUj4sSZI0WIEwKJf0BBQuJYLoCE+Hhjzzi7mw1N\
    YCOBtE/anfF7b2bem/dhz7NvXz739BVtWh17TMmhDL+EMuOhvHVxk53STuv66frkmwcFj3LS+uOD9w8pMx9m7SsFPgd5XfpoLO+MKXx2RmJGE6fFmmwW/maf\
    o2GcLqY4JfvEmoBdhyEs9XOuiwT7JEErWaOyNAnj5tIyinGLqEFEcWpV4LJNWZiGNO5CrZGIemG60YUiQUCTVJ0bMqiXF59toD6JVbcTRmkYO6AgSQLsETb7\
    QtgiwIdbbaEIChLQwwn9PZJpGxlUuDYNxIindvJujGPKL8tPKdJcY8o0tLOvcws5jJuIlQDh+clhaLh5aRCQhPjOKmVOO6FBGBE2Dvil5Yn3iml6nEW2HP3T\
    IuGUCfi5mGV9PvgB7iUrtBPBHnLcJPxI5NJ1Qc/h3lnRmR/vcbu7Av/N2V78sfm8rcz3iyb8t2ilaDM3/6FoilhqaoeiHRf81fnSVUEZVw5l0eDSdDNUFuh6\
    f6AcB35uQBs9c23x5TldetWLz189P4fRUeRyS+sWWrhw/cLC3ClTmjsNvTfUfGREIFDkwJimmXNYFeSGTdWlNEJdQXVmrrKMGAUHyvnPzMF47ML4Llkv05Qm\
    S+YyavFO7jn5DKaxBONXO4BIYh6smQQQl2ELN4naJDBzmmzk01zhfpdFNrRMigDLsb0K4H4dxAa1qF/Ij1aLnr+qZuSUtNokwWknIWJ3l4xllBBGkjWyR5IO\
    2Klig24UvSLzoZtquaFI1xrP/Hg2ouuZaXYe0ycn5BTbxbTPE74IjBUSRVRw/vZnDmOCnsOvIiDKIgAenOc07BZJ49b38MfdfWozXGHMrU+/24K/xee6c7cL\
    L3ASzi6UlRGMYAQjGAqMDXgWkTf+PP0cne9PmQOeNcjQUmaW7gakzM+2SZmZuKOUOYIRjOA/kzJLl0SuLClH+JMpjdOERpunoPMbcPIPvYF1g5nx+9cN8uMs\
    rx4wtWfyS/KIfB1HHcIPJRLhrHEMG5UNti8b7I0Yf2OfTYNumik3alcBKDdbua5Ijyplt7lZP/ehnZ98Pi9mGHY1Q/LI+pUibsd5paqnrNAVNsfmB43j17Lo\
    pQwsSdy706/KEKsfu1NFirRbVaYKVfYdL9IK6rLKzzLLCJXeFWML9vEe9i8netl/V/vYSz3sX8z0sr9zQDyI/SKelfYVJVPjR0AdyGqeSYij8Cb4FpzasY9T\
    /HWZp7ZWOyGMgcoO7FALpw104oTajealhxzZYSltOXxoA8WdKFL9ToL5bjVUJKOQxj5rIFvLQM38t6GeQt2c2/AiBJHDcJM4Hu3EIIcFqDZOVxoIRxB/Hm6f\
    5n+AhTSUQGpoOikkhC1TOiyMIRJJm3owVq9p/aBuWSghEYi3RhwusMMXzaTuXRd21PFDiHnKyzRZQVrdIsmu5ID9TLgcoU/iNAxCkjRQtlRK26HHnPUwXXF6\
    hQWp+qQ3YNWMvzCs3BGQCPWUTjP8oBTTQEvLGVG6SWaswiMgQWXUdKMNU25fPi+YHJ8wLwnb2SwrmIH+GQ2hq5cuLmq6g3WTEBObpkbMiuXVfbvmVjHWbd+o\
    EF236lqtari+aWLNrGqBrntV2zZcr67X6oalkV1vg6w0DWcLtqmK7lz/qmYZAWiDa6ama37Vqga2ValqngY9ndR1WycBJC3dq1VMG9dt2w7MulWz6sTWcA3v\
    Wn9xuxmO+vd/INr5Tui2ZlS8uo0tw6rXLFsLqrauazYhxK9ormEHbqVaMQKsYa+KbWJaQdXyLMO1bN30DUtdIwnPUw1Uf7j7qDh65/O/engbvXYYvXbYo9cO\
    o9Pc6DQ35NPccF5QD+F92L8/V069pgz+mOJJgX1LfERxONP3k4NS5B/kxxXKwUfz3tsDPr2Q7fTjgnBOMCsTW84q+xcEabJLqc2qzdgAIXOhxrv2UY6UvYce\
    kagr4suSVyf7KOWP89OV8lX/mKkbT+SdZj9l+ltBOdZP2V86kneuSankVylSgJeObO7TbfHZy1/QFrJK";

/// The three topics in SQLite, with their definitions.
pub(super) const ALL_DB3: &str = "\
    eNrtnO9v28YZxylLlm3mh7oGmFEY3g5It7Td2pCiRFFKjdhphDSbkzS2+yMwDOJEHmVuFE/mUU6cDoPlIEBXYK82YMCwl/0P9m4v1rzdiwF7PfRF1xfb2w7r\
    iwEDtt3xh0TbUhPXNjYUzweiSN49d8/3niMPPJ6t1bvLbkiQQ4MODpEmPSflctIiQpIkTfNtShpS5Fshc56Tns609JqVOycKn/mdVNo7/9m5T87+4ewFfgIA\
    AAAAAAAAwBF4t1icvTSf23F9mzwI3Q5hIe50Tdd+wA8ZbhM29cZKc2mtiW7evt58D+0zQXduo9QMvTTIQkurb7zc1yanZufnc3v1ELc8kpql+2JS69rSteXm\
    oJKXZBTh2tzdWvNGcwW9tXLz1tLKPfTD5r3vJ7kh7bqWmbG5fWcN3X57eXlgMFAyzsLGIUbXlu9cG+REGS/vPVeYmtW03KMbWdWmTRzXd0OX+mxE0uSotmQN\
    jtKscKdL0FrzvbVDmolvUdv121+SS2zzsPvR9sIPN2JW4HaFlbmJ2eZ+0yQk+fzU7Asv5B7hKCSRShZ/F/Y1PE57trb6uEPG6xqdw0jgYs99iCO5yVxzpCV1\
    HBLwWGxRZnYD6rgevz6PF4X+/ER8OZ9LLowQi2so3ecPXAJx6rPFIrU2t0nARH+Nu2hTw1H6fpKLOqm/Gslj1ibp4Ph7Yp+0OC0VFp8dcjxCZMBDabssDOgo\
    72Junit9IfEPAAAAAAAAAAAAAABfI+RCXpoLKGvhNovm/2e+J/EPAAAAAAAAAABDfraSm5Ryv/jOjEU73YAwNlzMbKBLl+RscofaJE7ssZB2TLH410B+z/Nk\
    uxdE66ANWSym+pQRi/o2ayBDiZCjRc+G/CrKWo6xRYNFa4v2fK5D50ldHG42EPY8025pr/GNp7EQB6Hrt02xwn6oQpO5vkVM0qUWL6nWlIPIh9wExOPitokp\
    5JrCZaQ563W48thAyXRDPqTjSCp4LAOhwrWJH7qOS4IGYlueGxJNjhexzftuuGnuV8tlHZBfltNF+3RlNg0JF4Uu/4i6fmhyqSFh8rhl6QZa35DHrW43kGUH\
    crpOzUUSn9HA7LA2u8y/Lv9AeFgVDuSxi9kNlKzgrtx8c1VRTaxqhGhY0xSiVXSrbhu1VhVj1bDLFaKqel2pVcstW9OwolUVR1WtqmGUW1ZdrdXLukKOHAaP\
    3mcDiccOQUBbNBxGYJneP2L7q4pednhrcE1TVMWu6lXH0CtVxVL4kUrqqqEShziOatUqmoHrhmE4Wl2v6XViKLiGj9x+e4cfuNbJNJ9f4fxG8IYBuB7X/lWu\
    BNVQyhWrbmC9rNdruqE4VUNVFYMQYleUVtlwWpVqpexgBVtVbBBNd6q6pZdbuqFqdlmXkz8baKC6mP/nz/9cKj0qneM7AAAAAAAAAAAAADh9fpqflubvXvhG\
    fy6dez991sxn2esbJzQvDiempW9fifyn7z7GvLXIej3ue4n3c9PSpaXIa/bF0/hXRlnnx30pFM3/p/8hnf/mmV2+AwAAAAAA+DryWOaPmXfnPlD7c09/vAwo\
    K4vc0I6N3iTYJgHajHYyCwPXb69voPjBTawbMXlfpTd9XoeDLfIO9nqEW7ppgrktUpi8cMLIt1ZvNNABwXKr53qh65sD9+zymtshKPpn66QdyAl4A0zXPiVN\
    YzTI/FwrI0YsuRcfJmvCpyTjS/pn2KHDboo71fEoDvUKz0m67YSmHI8v8DnHlbkP7vXnxkw1kitQhMZA195evbegpv317p2V6wsYXUQtEUNVR8vNd5rLC69q\
    aSBD1/qxHJf0yDbx0oI+DaOw6xXUcttyi1IPUX/QyNcXKhuI0U4aj9cXeHnc4uUzGm/RkAbr2gbqiIN40hLXoJXXefmtnhDvu7zeSIEIage3idwmvOYw2Imr\
    eUvcOTyvK/aDOHN3LDyl/j/YhiRA4k82Uv1oa3Bkb8lRdkg6XRLgsBeQJLrr5Q0UEEaCbXJKSkdEahCgB4OjncHRQ/mEpqSP2nxOujT3+P3+3Php6DMOjeL+\
    ydw+Xcqi3zbI3lHEo5Yb7mSSuDYahDA2jh8bT3D+X8x/Syqx83+deVL4df4TfgIAAKd/pViUcsU9Oz/7q9/8W//o+fhXL/++SqTnH0qT/LCFGRGWE3yb4Rvb\
    pD2PDyoiTfxgJvFa9H6Sn9qkQ6CwET+wGQ92cX6GxXj34uKocuI8HTdT/zHTSbnPP+5fmcyqf0UaquecrvrPr3419dJA/YcXC0L9LysT2dgLuflE3SbxPJoU\
    +9d/YnJJfsw/ExWFpNaziyIPt0RNuyJv97OkFdNS+oOmT3j67u//cig9Uvbxp5n0pI6Uq8sFuGMAADgZcodG03R0TMb43YuLH17MZ0fJZIy3T2yUjP0cHiWl\
    MaNkNCLCKAkAwP/NKNmXJ4rSTHGvcBKP8Qed7H/w/TQR8aer+9O/m9hXuZhcRswxn8oPtvzZxLyYiKksyqLO0m+l0helP5eelP5W+iM/AQAAAAAAAAAAAADg\
    f83ZfDGXvscoDk5ekaTJbE4hm5PP5kycyRdn0pz/AvlNMZg=";

/// Joint states in SQLite, each message compressed by Zstandard.
pub(super) const MESSAGE_DB3: &str = "\
    eNrt3EtsG0UYAOBZO3GaadIEKhFVaao5tE2K2sb25rkI1U6w2kCagG1oo6pa1rtje5C96+6M+z6QJgWJh+BSIUHhBCcEKkIghFRULkVw4orUA6qEEDeQKg4I\
    ELNrb+IkNrSiPUD/T/vwzv72/Dvey+yMNvPULBOU5B23bAiiol6kKChBCEJok1w70KqIXNsajhX0zzah/abS7X158+eo58KWm903ur7u2ioPAAAAAAAAAHfg\
    SCTSNzignGG2RU8LVqZcGOWKzqzT8iM3CpR3TKdTyWyKzMw9ljpK1oSQ+TkShJGhlVMkmZnes6i2d/QNDCgXJoWRK9EgLNhH6r+aTU7NplZ+ZAgTH7NkddnU\
    wVSaPJmeOZxML5AnUgt762eFU2Gm3hAzN58lc0/Pzq4ErGTSKsIyhEGmZuenVs74J/Zc6G3r6FNVZelgY9a6RfPMZoI5Nm9S1N7sWhoD7uSyxJkKJdnU0eyG\
    nKltOhazC39zllr6xuqbx3v1yCBuuqziRelFgxfXhtabJBzu6Nu2TVky/Cbxs+S1bduaC6+V3d612kaZts6r+RlOXWaU2FnDT7fe12wa6eTz1JVtccLhesV1\
    8qwk789/1wqLA6Ha7dxdvzGE4d1DwT687haold5eWwTR+knqcu//anXTBoHN8juv+H/SYsZPj5tFWjZq29Ca1GplQWK1ow0VN0nSlU1pMS5cp1ntXt9c6bmF\
    5AIAAAAAAAAAAID/EdwWRv2uw3NGgfv9/+7dSC4AAAAAAAAAANDFI0o7Ul4e7jSdcsWlnK+OY2vkLBcWbjxRdiyqBbMJsFnlwinr3vCvRuxqqYStquuPhGvY\
    G063HU5Nx7a4RiaiPuwPe2t4H2mMbBFLVqYtmE7VlunEZVHFEEVtdT5DTt0vV1nOheEKZhd0b57Fhh/VObNNqtOKY8pvx8aj6+ENVbm0JBM8SXUvZd2r1s97\
    fc2rY9AaqXc88YZc7igT2aauVwOzqC1YnlFXI/xEiQmq4tp0Bv0UE0V9bcYNqTW0Vm36RjBGHzSLTIoMP+cwW+gyVUE5bjVBQSPHjuNW8xw0YlouDmYsyCSp\
    zR1XL/MCH5ab4ce9GjJeBbjltAaN1Mfy0zOHMtGYbsRUSlVDVaNUHRkzJ62J8dyoYcQmrPgIjcXGJqPjo/GcpapGVB2N5mMxc3RiIp4zJ2Pjk/GxKMX1aQMa\
    mayN/y8huQAAAAAAAAAAAODeOadsQoPJrQ8s9q953ND6QYFpuceO36VHAX7/f8tDSC4AAAAAAAAAAO47SwXZJ032Xzy32N+6G+o6PO4VC6t29hA1LOqSor/D\
    XLjMLhw77o+k43zJMcTYiDysONx/t0FD0UlackwmzjQU0XzecQV+9C7DhzMHNbIuY5yrspJgti4vjLp5w6R8OMvKlPgvoqhfCMm78jp0Zt2jnFrkgOWxGiec\
    mrha+1ifJYHvYv8/1LML9VySGwAAAAAAAAAA4H5mhyKoM7I42/fG5T/H3n0QDX0y/Ac5fzWE4ss9A1cGP1D2ojd3zuyIvf/izbbi1beffy/x0lB81ysfHU7v\
    vnJtYfv1V/f8ujz10zvbP3y995srX9z4fV9ISyunl66/pnSiZ689sstOtu9DsWdeSKDpH75c+LiLKX59U359D6N6fZdCaDnsv3X/lwz10mqXa87gIbnrlCsv\
    OtWSRV3vPf20lHNO/XwAJULff3tgZ2IkgWVFiZtzXyWOvtW2FPtMSeyY/u63T5cV7Pf/f0Q9t+QGAAAAAAAAAAAA/2Vd4YgSPL0IbQ5HOoNHC38B4hNSYw==";

/// Joint states in SQLite, the file compressed by Zstandard.
pub(super) const FILE_DB3: &str = "\
    eNoBywQ0+yi1L/0AWBUmANa7yEcQr6gDAGADuYAqAoQKgAIAgAoQBChoQnvvvBCRkkGkvHxpZCfZJJVj8Fq842D5KVRu6PqhxhoJywe7SH+vb7fCUbqeD2J3\
    Cr8AqwC0ADnOb1U6LVd/JZNa+b9sska1NNNKu5+RJSfTNNFGBgCcBSswLisus5wuLhhefAXzEjn6srmBhhQF1xCjUqElxoLHpFhSq5cWn9ShgpTLisrq8x5L\
    5hNOJiIi2tDQYgsgqFRcgfsLjLtMKsJLi6dWKqkYCBv4WxLj/zxMGl+fzPg/mj38rNQmE0kg+nwytAmPAR8nPlKAVoDghNqEx6e7QRk30hyddUZ3f3qjuzm6\
    2x3VWdYAWvMsv2s7/0xdLqgCGbuPaKw5orFmdGX5cocl33KFWS66O4AbHKH4hme13GNbZXWH24VN6Hmw6pvMcsbPZgzj4Hu08+2n/eDM+MY3jP++Pst1kERk\
    rZHJhDgA6gMg3JIsbG9IezIgjFDDCGXdDbI3Yzojtrcjv3dxWBXLQFRL8f2a6JFZTplBHZEYfo929r4ithzi/PtdZ+UN9SS9jz9ZM7DMyQoUEG14PC4sXbFa\
    ml/0cvhn/JdNOQRAmgAIzcydXEgswACVBM2RfcgJdU7o5Bv8kal0OiGdOFYJBcWEI5G6kYk2kpo2WSWTk9HJRCJ9SWmikKQ0YZ2gzBNnKtF+pGlS+9dIMpJG\
    KgktMe6+fZZZlSu1E0ha+CPBLfzFa3F97Nu/bPKdnG80M77hzzLjmCu1G0h8+y86gK5MO0SofaYeB+zbfdrRXH/SazOGvrmyfMWvoVl6f+HohOSbi7Ovj89V\
    iuN/NMdWpfnK3QxMMUiMEHV8PB6d7OP5aBGCEeoWoU53Q1SJgU5x0d0MMhhDmaAQpKDoFBXdQXE0qoNleX9/ejDrwt3d0d2dx5LV3Rp9I6Bf9UJACVMMEiNE\
    GTifjv50YIwFCA41C5AOhEHusZe0XCmcNP4nb+f+H12R4Odkdz9XGivNHoWxoG8sqgrwAczXdt3bZMpZ72uwfTnNTIkpS+t1kGamVenNGLr8/pQvYWbcwl8J\
    2xsS+xAiRKU5slaAmqghHUNIGSEakUCENCkMB2ACkak5UhA3EmBQaZbmKIqjEDHKEEUIEghJ7AQkgQQSkIKCdP9AZOa3DmRjyAqGQ3HeojaQ2tXubfj/Ujxj\
    tkEz2PeSSAAcsJeZTWoOfHRwAOhNCXIB2zzkh3RBZPq2UQ0NaC2nzYyPYlpAkAwSgwZI11JctNsAUvR3E+w+AKaYHICJLNDF5MCdtoQQo2wYACJFmQWyejRo\
    g1UA1H1o9jpYGWgzKdhHmm2OOE6fdBpuTTySAYEVBIw02DlOPRwxkxXxJXx+36HT5G/Ug4N4zWFRc+b12nBT+gmYJxjUfWTQaGDvRCNTFAlP8HM8ruxtglEY\
    DkDJngIW92zyDzDA9NxFmpcl4hxoh1oPux2peFDjS73pxMCoALRBx/c/aJN40TC6JyooSwOIBFVMvGUPMb75UhmTAypbmuy33wN9PqsjDCiXh4Uy3NXyrDEj\
    uj7sZZ2tw/G0HqQYnty2ChDxe+7wJ9A6+8UoUdEALkLqDq0Z6BJjiiwxE8IUS72NZ1H5gmBsVZ+RJhPEbDK5f3TUOSk=";

/// Two topics in a bag of ROS 1.
pub(super) const ROS1: &str = "\
    eNrtWktrFEEQntkkJhkUNV4CXhoiPvCRx74SyZBVDIpEFBcVCWGdR81mzMz0Zro3MTnl6l3wJwhevat3L/4E9RcoXgQPWj3Ts7Mb1xcqBOkPmu6u7uqp6a76\
    mOrdiZvX6xcvXCa3Z85NGYuapg1ioS1zYAxrP3LhQaNFmfmEaAkOYnFoFDUc2o64WcDuISFabUdrUqZj/xnOIwoKCgoKCgoKCgoKCgoKCnsRp/L8fyhJ62nY\
    ioExn0ZmRCMYRRnzt8F8hfm9KGdyheFReTVginuCI1g4bfmOOXmf+hFvMG5xYPf07w4dFeKtFpgMIkbjRsiabPKqmFAX4ydwOHTLrB2axalKxXXcasWqOJ4F\
    Xrk6Z7tTXrE0XS3CnOd+FlPRaqsJDRc8P/K5eAHG3XTRK2C5EJPVpDIYj/2oubxCIisEwwuoxSsl7LYoS/S6RBsQUMfnW10i8Dwac8P8yzCu1S+fJ7ssNtq4\
    GcUZwmDd4H4IOG6FLfkCxIvR/obvGsfzMyn0nMkBscOoZ2of6iAEPpYh0ZB9oWVbDMStzog46lXaDvDBYg4ENt0saBneL8hGLZe9kbLXC7nsWC2tS7VfNGts\
    OzFrX2YW9n/DLE0+buQnZh2X88q1k/08WJc3XdJNA7qZ+OjjQl/xeOa5MbUpT09siW7udtuq48yW52x7tmzhcc7aUzaUqt40nqxd9YrouYW+bisOfZZcvFW/\
    a05nZ33n+s1LpkUmiG3g6HSFLC3eXlwyzxYzF+G+s2akmgGg22aKEeUgVColYvtNw6Y0IF0uPm+WVgijGAfp/HkT9S0b9bte7RrlNF4urpBQNNLoTVcoziyj\
    /nobBXEkQiexAKPED/GljCbgyjzeSpe5IUI7iTOsWWYCPo79q3Da/Q5yg0Lqduwn652Wu24kwxzCFsQWb8cgd3d5ZoUgK0K8Af/I0j471dmgB51Wh4fIdv+g\
    1/sF/Uec5mI9IMJnFYKAfv6SQh/oxMcnGTODMk72J/Fk2boc33k3LINRSHDyzvO3XZIdof7iTSaRggwLS4OagoKCwl+B3uezJPsOSOlnovaLBImfG4Ig4Q8I\
    MuG6HoJ8+Q1BJvYpglRQUNgbBDmZE+Sg4KQNiBN+7MnVjKST/fI/3pU7PtLzhO00Dv50Of2Hyz0cypd7aqiLhr140aBSZ5U6/weps5u78b5uphrr/K9J/AHq\
    wKGUMAWp4LnFvNGTVR8Wd1GR2+j5kuylN7mAVpCELOqvhD1Wmw==";

/// The same with chunks compressed by bzip2.
pub(super) const ROS1_BZ2: &str = "\
    eNpTDvIPdnJ0Vwgz0jPgcmVgYGAB4vwCW2YhIJ2Zl5JaEV+QX2zLKsIABvxAnJyflxefnF+aV2LLBOQKgIQySvOyoWKMQP5moDqFUTAKRsEoGAWjYBSMglEw\
    CkbBKBgFo2AUDEaggej/s0J6+rkFRanFxZn5ebZJVUacQKHizKpU29NASS1mBganqAxLQ8dIteBInddRqQyMDv/f//82w8P32P9v167fXvX///8PDgwMDQyM\
    BxgcGAoYMjwOMP3dHHFzyuJElY6Vr6pFTgIJzeVLrhhlZDYwzMp15jjI08t85KLxFaaAJrbOTlObtuVLbrXNW8DAwDNLioEhha3BgiGDl9mB2deIgVcqhSHj\
    ZBOzAAOTp+akumWdi4FWARWZMDCcYGAwC66XNE2+6zIrUGay4vsZfFKKCxQCe3g0Dx8K8tzurbhKcnOeLWOovpBzxCqtLsPAFu+Dv45xcK00SJrm+TZCrZeD\
    qzd0UmAP8w2HT4Inz7TIPxMQWubJlzLpqGRbMeP+DQ7z8h0eXThoMKdiIp9t8dJFColhk/jEDhxwC5B94C8z8Uegw8UJHEv6nXlfzT5ZsWLnugNx7ey+z1rP\
    Zq6MvfmiRNjp3vf3Vj1qkxR55OX+XZM7d+78wX/csjYhSeIbjSYbe16sfub3/sGr75Zaaz2OVR8IOL563dvMvCP+0+4kqbAfLvZlW6/dJHy2i1s5bgm/yA5T\
    J+up0aV6IXeL3W6uyneKnW1lI2qxKGNC5e8vm+O0ODSPuHikT1wjsHqy5IJCqfawj9d9P5xekZAZb5Z7r7v8+stabu+fj5tuJfMcePT3a/OeyPvRnzzDH+64\
    LC350eaC2UzrI+dOR7VaedcUd08ry5m95e+Zje+yLps8mZzRvVHxobNGntSsssDMl9aXfTeqrHn7nu3cMo99Ht1xSpVx/tbbT/JMS77uddVI/nRqWllOz6nY\
    OQW5glLn7/30XpvUmaAmFRaic2IS+8ZgDm27pDM/Ju/0m2ha+XZRyI+shtfMbdqsvj6FRRIBE1f7pYS6hjmJrlTTe9pdKNWmLtkVyNrZ0Vh79IslW8Gjxst3\
    mC85aXJO2OrO8WIHk0pHsLcr7y1v0YqOx1yPpm1YwzU5oks02ubwNofM6+y31Bpn6Ppc39Q8NWjb5ToW2YU302oEKxz0hDVt3k+Q6JJfypSe+kxjrWtGhuqs\
    SY2BoQ4hXhPdlx1YYftqiobO17aQgCZXbi71Hv+Ql1FLWVm/XtVQ7FCQWLW0kuXCzfQPfLEsrU5OgqcEJBL0nk93vVHBvVNpjoaHWOlaowZ9RM5i4QDSZalF\
    4IEyTuh4mi1ocI0LzIGNq0mAhD4Gp4KoKYxQtlAVgzZQkqBxjHiN62RFGLcKqEwHYRw7iouEgbgkvyAz2VY/Kz8zryS+uCSxJLU4gRGnlDRIuLIg1bY4Na84\
    vyg+tzi9WN8LpCAYJK8OlM5NMS0uzbU1NjAzS0lOMTdLNEtOS0xNMzW3TEoxSDM2MTQ3TrVMS/kNUgosfBLTU+NTUtMy8zJLQOVQcUkKxFCP1MSU1CKFDDDF\
    VVxSlJmXHh2rkJeYm8qVlpOfWGJmAuQW5BeD9SEJlaXm5CdnllQiCaWmpeUXlXDZUhlw+Qa7WymguZirFBgYxkYKxamFXCWZualA+cTcAqgHFNKKgO6Pz0zh\
    0sAWJ4zQIVhowOfkl4NDfToTVmEJWFwU5Sfll0Dc4JNfjh4R5snJFqaWSUkWpolAB1okGSSlmpinGQLdmmSeZgyMCyasEQHyhoWCU2hwpK0hzPXh/kEutokK\
    ygpJXEBZQzMFH9cwVx9bXWOYp0syk7O5IDpzUoERAdOYl1+SCtJiZqKQlJnOlZSfn6OAFGk2tiaxCsX5wJiFqLexBepPTALqR/Kab35JflG0caxCLogBSY8Q\
    E4yNooH6C0uBAkV5oMQAdgEw3jNzgZ7iSk8FmlxSVAkxJgCUWMEpB0gXw5wAtK6YVgkE3Q/QAMrNT4G7X6EQzkop5AJLl6TmFqQWJZaUFqVCQzfaKFYBWF2n\
    FpWl0silWEIKHkAVcBY8ZylUcaUgkjEbckklBJ81AE0v8ApAphdAhQow3opK4kE5wxZWXgkCcWpeCpIgsOBCLd6gBjCA2IxQGgDW6Pxl";

/// The same with chunks compressed by LZ4.
pub(super) const ROS1_LZ4: &str = "\
    eNrtWV1oHFUUPvfObn6GhGx3A6aU0smPMbbaTbKb3Y1myDY2VCSlS0IrUsI6s3M3Gbs7dzMz25990CgF7ZOChfXN+iCCL0IFCz7YWsSCfdEXQfpg1Vcf0tRA\
    pUg8d/+bptWCBR/mg+Hee+65Z84959xvd+8Ozh9ZmDlwSDk2vn9UngUAHz68oEpBbE3LYKfTBe6oH/VCBT34ZLhlpTO8aLkqxWFAiJaL1omajOD4c9RTPHjw\
    4MGDBw8ePHjw4MGDBw//R4w0f//7q7/08wWbOY7JLTVXinaiyDFLTL2Ok99KqDtwuG85KUYCr3+Gos3BZ5pG2jtr1wWqmA/h4/KCmVHDr3HTctOOq7nMeZXs\
    grbArnFYo2cKTHWY5XA7nXeWnPBLUxBYeB7Wdj+FS/PGhFPMq5HRWMzIGPGYFstkNZadiE/qxmg2Eh2LR9hk1ri7D9bb0GdtiaUNljUt0xXuO65xFN58kWkG\
    s5XldrjVLTuubVpLxxcVS8szOZvjmhuL4rDAnQS0h+DtkyzHM6Z7JgTvsmyW266sEpg6IR9eOPScchFut8tF3EZkXHHYiuyaeabgjvKFr+ELJWujzbRpyMPn\
    yU56ngS6dbKKGircWmAfk5SJG/J3ghQA+I6s+XXNYeIupUNEeJkXc+jlEKRYTuendgKlMLA23QHDkOyF0M1eGP5+uhcGhpIjEI4my9DbHyyVIdAWBygD9jXa\
    g8IQcNjTUYau0PAIxCaSI/tJ21WaEtczPfsJvUrHcvzUZRou0yeABvr2AnxJ522uc9egU3P81CW6GYpnMomJSV1PTGgYuYQ+qrNoPDuGQdTj2QjGm15C5zbI\
    2YQyc3ThFXXsd/KH/PKR+YOqpgwquozhGYspc7PHZufUZyOD9IBrZk50gZtQcgyjOwlJi7ssAtdiUUU3l2Sd85zyG31/So0uKg7Ps1H4ZEpFbU1nOfkGXDjM\
    XW4fjywq+U6gP0k0KK2TyPhx1F4pYjHZFub6LVinmEYzjyUgLzG04tpnBkggdUMiy9IM+uQcAI5vzGnOEWm26xugH8ILSp4bd6QZzObKOUhhY6w8TX5IKC7L\
    F5ituUWbjcHP+K7xRQXPBLNPsj+lgz17CdAPYBatnZbB/44vrJQ2JAmu0e4N6b3beA4MjLf0o2Qvs1yO390koBCpKBEKoTvXpZBvRNrRlZIUTZ8HoBBZ/bV9\
    yAdBWJoGWP3qlyAEVqdh6PLNIEg7wEdBmZ4zfT0UNhFTcNaH0W8rd9AABDuu+MKrg290SDAJcr8fy6DfD3s6e/r9T5K/fJ39/t1X+v3kAqBALC6l8AWDSXEu\
    w80D6xMFeJLZlUu8ew6vXBnU7/z6hAgrWTTnSa0fLME++i/MkYeaO+dvmvsU1R6dTh44tUuI7+MYobAg5h+FZITqtiRTNVrnmUrzMKKprGsR1SmnRVSnnv8Y\
    VRbb4vH2hFbbQJPURrbLCaldD9cCj+RSiXqZbivuq+eiwjhVH5B0tibinwlo20SIbdQpqe79A2mpvmnBTXJ1ZYWd6gsFRYklrRzVkrQGV9X0m3zVsrUmb4lO\
    tR6rFrayV9WD+/iraiYlirVSOYLF6i4IIntcBbJ1D7UAIVk2/FdWGj1jRa5Mt5BmLbottPmYPN0mUo0AnW70GidLKclGs4zbWpkq2PhHQ/z10R2ofr0RpIJ5\
    s920W/8gF+Id+DDLaBEicd1LbzUDIPqk1v4NTTafTw==";

/// The bytes of one of the bags.
pub(super) fn bytes(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    ZlibDecoder::new(from_base64(text).as_slice()).read_to_end(&mut bytes).unwrap();
    bytes
}

fn from_base64(text: &str) -> Vec<u8> {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits: Vec<u32> =
        text.bytes().filter_map(|letter| LETTERS.iter().position(|l| *l == letter)).map(|digit| digit as u32).collect();
    let bytes = |four: &[u32]| {
        let word = (0..4).fold(0, |word, i| word << 6 | four.get(i).copied().unwrap_or(0));
        word.to_be_bytes()[1..four.len()].to_vec()
    };
    digits.chunks(4).flat_map(bytes).collect()
}
