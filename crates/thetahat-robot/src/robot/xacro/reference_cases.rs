//! Files of each feature, and what the PyPI package `xacro` 2.1.1 makes of them (Python 3, PyYAML 6.0.4): its output without
//! comments and white space.

/// A xacro with the files it includes.
pub(super) struct Case {
    pub(super) name: &'static str,
    /// Paths and contents.
    pub(super) files: &'static [(&'static str, &'static str)],
    pub(super) arguments: &'static [&'static str],
    pub(super) expected: &'static str,
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "properties",
        files: &[(
            "robot.xacro",
            r#"<robot name="p" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="mass" value="2.5"/>
  <xacro:property name="half" value="${mass / 2}"/>
  <xacro:property name="later" value="${later_defined * 2}"/>
  <xacro:property name="later_defined" value="21"/>
  <xacro:property name="quoted" value="'007'"/>
  <xacro:property name="flag" value="true"/>
  <xacro:property name="tiny" value="${1e-5 * 1}"/>
  <xacro:property name="kept" value="1"/>
  <xacro:property name="kept" default="2"/>
  <xacro:property name="given" default="3"/>
  <xacro:property name="name_1" value="1_0"/>
  <xacro:property name="x_${kept}" value="made"/>
  <xacro:property name="eager" value="${mass}" lazy_eval="false"/>
  <xacro:property name="mass" value="7"/>
  <link name="a" mass="${mass}" half="${half}" later="${later}" quoted="${quoted}x" flag="${flag}" tiny="${tiny}"/>
  <link name="b" kept="${kept}" given="${given}" under="${name_1}" x="${x_1}" eager="${eager}" plain="$ 5" both="$${x} $$(y)"/>
  <link name="c">text ${mass} and ${half}</link>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="p"><link name="a" mass="7" half="3.5" later="42" quoted="7x" flag="True" tiny="1e-05"/><link name="b" kept="1" given="3" under="1_0" x="made" eager="2.5" plain="$ 5" both="${x} $(y)"/><link name="c">text 7 and 3.5</link></robot>"#,
    },
    Case {
        name: "expressions",
        files: &[(
            "robot.xacro",
            r#"<robot name="e" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="n" value="7"/>
  <v a="${1 + 2 * 3}" b="${(1 + 2) * 3}" c="${7 / 2}" d="${7 // 2}" e="${-7 // 2}" f="${-7 % 3}" g="${2 ** 10}" h="${2 ** -1}" i="${-2 ** 2}"/>
  <v a="${n &gt; 3 and n &lt; 9}" b="${not n == 7}" c="${1 &lt; n &lt;= 7 != 3}" d="${n or 3}" e="${0 or 'none'}" f="${'yes' if n % 2 else 'no'}"/>
  <v a="${'arm' + '_' + str(n)}" b="${'ab' * 2}" c="${'rm' in 'arm'}" d="${[1, 2.5, 'x'][1]}" e="${(1, 2, 3)[-1]}" f="${'armature'[0:3]}" g="${'armature'[-4:]}"/>
  <v a="${sin(pi / 6)}" b="${cos(radians(60))}" c="${degrees(atan2(1, 1))}" d="${sqrt(2)}" e="${math.hypot(3, 4)}" f="${asin(1) + acos(0) + atan(0) + tan(0)}"/>
  <v a="${min(3, 1, 2)}" b="${max([4, 9])}" c="${round(2.5)}" d="${round(2.675, 2)}" e="${int('12') + int(3.9)}" f="${float(3)}" g="${len('abc') + len([1, 2])}" h="${bool(0)}" i="${python.abs(-3)}"/>
  <v a="${0.1 + 0.2}" b="${1e16}" c="${1.5e-7}" d="${100000.0 * 10}" e="${3 * 1.0}" f="${1e3}" g="${floor(-2.5)}" h="${ceil(2.1)}" i="${True + 1}"/>
  <v a="${dict(x=1, y=[2, 3])['y'][0]}" b="${dict(x=4).get('x')}" c="${'a-b-c'.split('-')[1]}" d="${'_'.join(['l', 'r'])}" e="${'Left'.lower()}" f="${[1, 2] + [3]}" g="${'a b'.replace(' ', '_')}" h="${n in [1, 7]}" i="${None}"/>
  <v a="${ n }" b="x${n}y${n*2}" c="${python.sum([1, 2, 3])}" d="${sorted([3, 1])}" e="${list(range(3))}" f="${'it''s'}" g='${"double"}' h="${1 if False else 2 if False else 3}" i="${0x10}"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="e"><v a="7" b="9" c="3.5" d="3" e="-4" f="2" g="1024" h="0.5" i="-4"/><v a="True" b="False" c="True" d="7" e="none" f="yes"/><v a="arm_7" b="abab" c="True" d="2.5" e="3" f="arm" g="ture"/><v a="0.49999999999999994" b="0.5000000000000001" c="45.0" d="1.4142135623730951" e="5.0" f="3.141592653589793"/><v a="1" b="9" c="2" d="2.67" e="15" f="3.0" g="5" h="False" i="3"/><v a="0.30000000000000004" b="1e+16" c="1.5e-07" d="1000000.0" e="3.0" f="1000.0" g="-3" h="3" i="2"/><v a="2" b="4" c="b" d="l_r" e="left" f="[1, 2, 3]" g="a_b" h="True" i="None"/><v a="7" b="x7y14" c="6" d="[1, 3]" e="[0, 1, 2]" f="its" g="double" h="3" i="16"/></robot>"#,
    },
    Case {
        name: "macros",
        files: &[(
            "robot.xacro",
            r#"<robot name="m" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="color" value="red"/>
  <xacro:property name="size" value="4"/>
  <xacro:macro name="leg" params="name parent:='base' length:=0.5 mass:=${size * 2} *origin **extra">
    <link name="${name}" length="${length}" mass="${mass}" color="${color}"/>
    <joint name="${name}_joint" type="fixed">
      <parent link="${parent}"/>
      <child link="${name}"/>
      <xacro:insert_block name="origin"/>
      <xacro:insert_block name="extra"/>
    </joint>
  </xacro:macro>
  <xacro:leg name="left" length="${0.1 + 0.2}"><origin xyz="${size} 0 0"/><extra><axis xyz="0 0 1"/><dynamics damping="1"/></extra></xacro:leg>
  <xacro:leg name="right" parent="torso"><origin xyz="0 1 0"/><extra/></xacro:leg>
  <xacro:macro name="forward" params="size:=^ color:=^|blue other:=^|9">
    <xacro:inner size="${size}" color="${color}" other="${other}"/>
  </xacro:macro>
  <xacro:macro name="inner" params="size color other"><v size="${size}" color="${color}" other="${other}"/></xacro:macro>
  <xacro:forward/>
  <xacro:forward size="1" color="green" other="x"/>
  <xacro:call macro="inner" size="0" color="c" other="o"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="m"><link name="left" length="0.30000000000000004" mass="8" color="red"/><joint name="left_joint" type="fixed"><parent link="base"/><child link="left"/><origin xyz="4 0 0"/><axis xyz="0 0 1"/><dynamics damping="1"/></joint><link name="right" length="0.5" mass="8" color="red"/><joint name="right_joint" type="fixed"><parent link="torso"/><child link="right"/><origin xyz="0 1 0"/></joint><v size="4" color="red" other="9"/><v size="1" color="green" other="x"/><v size="0" color="c" other="o"/></robot>"#,
    },
    Case {
        name: "recursion",
        files: &[(
            "robot.xacro",
            r#"<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="chain" params="i n">
    <link name="l${i}"/>
    <xacro:if value="${i &lt; n}"><xacro:chain i="${i + 1}" n="${n}"/></xacro:if>
  </xacro:macro>
  <xacro:chain i="1" n="5"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="r"><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/><link name="l5"/></robot>"#,
    },
    Case {
        name: "scopes",
        files: &[(
            "robot.xacro",
            r#"<robot name="s" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="a" value="1"/>
  <xacro:macro name="local" params=""><xacro:property name="a" value="2"/><v local="${a}"/></xacro:macro>
  <xacro:local/>
  <v after="${a}"/>
  <xacro:macro name="global" params="">
    <xacro:property name="g" value="${a + 10}" scope="global"/>
    <xacro:property name="p" value="5" scope="parent"/>
  </xacro:macro>
  <xacro:macro name="outer" params=""><xacro:global/><v p="${p}" g="${g}"/></xacro:macro>
  <xacro:outer/>
  <v g="${g}"/>
  <xacro:property name="gone" value="1"/>
  <xacro:property name="gone" remove="true"/>
  <xacro:property name="gone" default="2"/>
  <v gone="${gone}"/>
  <xacro:macro name="uses_callers" params=""><v callers="${secret}"/></xacro:macro>
  <xacro:macro name="caller" params="secret"><xacro:uses_callers/></xacro:macro>
  <xacro:caller secret="42"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="s"><v local="2"/><v after="1"/><v p="5" g="11"/><v g="11"/><v gone="2"/><v callers="42"/></robot>"#,
    },
    Case {
        name: "conditions",
        files: &[(
            "robot.xacro",
            r#"<robot name="c" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="gripper" default="true"/>
  <xacro:arg name="count" default="3"/>
  <xacro:property name="count" value="$(arg count)"/>
  <xacro:if value="$(arg gripper)"><link name="gripper"/></xacro:if>
  <xacro:unless value="$(arg gripper)"><link name="none"/></xacro:unless>
  <xacro:if value="${count == 4}"><link name="four"/></xacro:if>
  <xacro:if value="0"><link name="zero"/></xacro:if>
  <xacro:unless value="${count &gt; 9}"><link name="few"><xacro:if value="1"><inertial/></xacro:if></link></xacro:unless>
  <v sum="${$(arg count) + 1}" arg="$(arg count)0" path="a/$(arg robot)/b" optional="$(optenv NO_SUCH_VARIABLE here or there)" own="${xacro.arg('robot')}"/>
</robot>"#,
        )],
        arguments: &["count:=4", "robot:=r2"],
        expected: r#"<robot name="c"><link name="gripper"/><link name="four"/><link name="few"><inertial/></link><v sum="5" arg="40" path="a/r2/b" optional="here or there" own="r2"/></robot>"#,
    },
    Case {
        name: "includes",
        files: &[
            (
                "robot.xacro",
                r#"<robot name="i" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="parts/wheel.xacro"/>
  <xacro:include filename="$(find demo_description)/urdf/extra.xacro"/>
  <xacro:include filename="parts/absent.xacro" optional="true"/>
  <xacro:include filename="parts/named.xacro" ns="lib"/>
  <xacro:wheel name="front" radius="${wheel_radius}"/>
  <xacro:lib.part name="x"/>
  <v lib="${lib.thickness}" extra="${extra}"/>
</robot>"#,
            ),
            (
                "parts/wheel.xacro",
                r#"<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="wheel_radius" value="0.3"/>
  <xacro:macro name="wheel" params="name radius"><link name="${name}_wheel" radius="${radius}"/></xacro:macro>
  <link name="from_wheel_file"/>
  <xacro:include filename="more/deeper.xacro"/>
</robot>"#,
            ),
            (
                "parts/more/deeper.xacro",
                r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="deeper" r="${wheel_radius}"/></robot>"#,
            ),
            (
                "parts/named.xacro",
                r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="thickness" value="0.01"/>
 <xacro:macro name="part" params="name"><link name="part_${name}" t="${thickness}"/></xacro:macro></robot>"#,
            ),
            ("demo_description/package.xml", r#"<package><name>demo_description</name></package>"#),
            (
                "demo_description/urdf/extra.xacro",
                r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="extra" value="${wheel_radius * 2}"/></robot>"#,
            ),
        ],
        arguments: &[],
        expected: r#"<robot name="i"><link name="from_wheel_file"/><link name="deeper" r="0.3"/><link name="front_wheel" radius="0.3"/><link name="part_x" t="0.01"/><v lib="0.01" extra="0.6"/></robot>"#,
    },
    Case {
        name: "blocks",
        files: &[(
            "robot.xacro",
            r#"<robot name="b" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="n" value="1"/>
  <xacro:property name="shape"><box size="${n} 1 1"/><other n="${n}"/></xacro:property>
  <xacro:property name="n" value="2"/>
  <link name="a"><xacro:insert_block name="shape"/></link>
  <link name="b"><xacro:insert_block name="shape"/></link>
  <xacro:macro name="two" params="*first *second"><t><xacro:insert_block name="second"/><xacro:insert_block name="first"/></t></xacro:macro>
  <xacro:two><f a="${n}"/><xacro:if value="true"><s>${n + 1}</s></xacro:if></xacro:two>
  <xacro:macro name="pass" params="**content"><xacro:two><w><xacro:insert_block name="content"/></w><s/></xacro:two></xacro:macro>
  <xacro:pass><c><in1/><in2 x="${n}"/></c></xacro:pass>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="b"><link name="a"><box size="2 1 1"/><other n="2"/></link><link name="b"><box size="2 1 1"/><other n="2"/></link><t><s>3</s><f a="2"/></t><t><s/><w><in1/><in2 x="2"/></w></t></robot>"#,
    },
    Case {
        name: "elements",
        files: &[(
            "robot.xacro",
            r#"<robot name="d" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="kind" value="sphere"/>
  <xacro:element xacro:name="${kind}" radius="0.1"><child n="${kind}"/></xacro:element>
  <link name="l" mass="1"><xacro:attribute name="${kind}_size" value="${2 * 3}"/><xacro:attribute name="mass" value="5"/></link>
  <escaped text="a &amp; b &lt; c &quot;q&quot;" more="${'&amp;'}">x &lt; y &amp; z</escaped>
  <!-- a comment with ${undefined} -->
  <with><![CDATA[raw <text>]]></with>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="d"><sphere radius="0.1"><child n="sphere"/></sphere><link name="l" mass="5" sphere_size="6"/><escaped text='a &amp; b &lt; c "q"' more="&amp;">x &lt; y &amp; z</escaped><with>raw &lt;text&gt;</with></robot>"#,
    },
    Case {
        name: "yaml",
        files: &[
            (
                "robot.xacro",
                r#"<robot name="y" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="config" value="${xacro.load_yaml('config/limits.yaml')}"/>
  <xacro:property name="old" value="${load_yaml('config/limits.yaml')}"/>
  <xacro:property name="shoulder" value="${config['limits']['shoulder']}"/>
  <limit max="${shoulder['max']}" min="${config.limits.shoulder.min}" effort="${shoulder.effort}" name="${config['names'][1]}" deg="${round(config['turn'], 9)}" yes="${config['flag']}" list="${config['nested'][0]['b'] + 1}"/>
  <limit count="${len(config['names'])}" has="${'elbow' in config['limits']}" text="${config['text']}" none="${config['empty']}" old="${old['version']}"/>
</robot>"#,
            ),
            (
                "config/limits.yaml",
                r#"# limits
version: 1.10
limits:
  shoulder: {max: 3.14, min: -3.14, effort: 150}
  elbow:
    max: 2.0
names: [a, "b c", d]
turn: !degrees 90.0
flag: yes
nested:
  - a: 1
    b: 41
  - c: 2
text: 'one: two # three'
empty:
"#,
            ),
        ],
        arguments: &[],
        expected: r#"<robot name="y"><limit max="3.14" min="-3.14" effort="150" name="b c" deg="1.570796327" yes="True" list="42"/><limit count="3" has="True" text="one: two # three" none="None" old="1.1"/></robot>"#,
    },
    Case {
        name: "arm",
        files: &[(
            "robot.xacro",
            r#"<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="prefix" default=""/>
  <xacro:property name="prefix" value="$(arg prefix)"/>
  <xacro:property name="lengths" value="${[0.4, 0.3]}"/>
  <xacro:macro name="cylinder_inertial" params="mass radius length *origin">
    <inertial>
      <mass value="${mass}"/>
      <xacro:insert_block name="origin"/>
      <inertia ixx="${mass * (3 * radius**2 + length**2) / 12}" ixy="0.0" ixz="0.0" iyy="${mass * (3 * radius**2 + length**2) / 12}" iyz="0.0" izz="${mass * radius**2 / 2}"/>
    </inertial>
  </xacro:macro>
  <xacro:macro name="segment" params="index parent at">
    <link name="${prefix}l${index}">
      <xacro:cylinder_inertial mass="${2.0 / index}" radius="0.05" length="${lengths[index - 1]}"><origin xyz="0 0 ${lengths[index - 1] / 2}" rpy="0 0 0"/></xacro:cylinder_inertial>
    </link>
    <joint name="${prefix}j${index}" type="revolute">
      <parent link="${parent}"/><child link="${prefix}l${index}"/>
      <origin xyz="0 0 ${at}" rpy="${pi / 2 if index == 2 else 0} 0 0"/><axis xyz="0 1 0"/>
      <limit lower="${-radians(170)}" upper="${radians(170)}" effort="${100 // index}" velocity="${pi}"/>
    </joint>
  </xacro:macro>
  <link name="${prefix}base"/>
  <xacro:segment index="1" parent="${prefix}base" at="0.1"/>
  <xacro:segment index="2" parent="${prefix}l1" at="${lengths[0]}"/>
</robot>"#,
        )],
        arguments: &["prefix:=left_"],
        expected: r#"<robot name="arm"><link name="left_base"/><link name="left_l1"><inertial><mass value="2.0"/><origin xyz="0 0 0.2" rpy="0 0 0"/><inertia ixx="0.027916666666666673" ixy="0.0" ixz="0.0" iyy="0.027916666666666673" iyz="0.0" izz="0.0025000000000000005"/></inertial></link><joint name="left_j1" type="revolute"><parent link="left_base"/><child link="left_l1"/><origin xyz="0 0 0.1" rpy="0 0 0"/><axis xyz="0 1 0"/><limit lower="-2.9670597283903604" upper="2.9670597283903604" effort="100" velocity="3.141592653589793"/></joint><link name="left_l2"><inertial><mass value="1.0"/><origin xyz="0 0 0.15" rpy="0 0 0"/><inertia ixx="0.008125" ixy="0.0" ixz="0.0" iyy="0.008125" iyz="0.0" izz="0.0012500000000000002"/></inertial></link><joint name="left_j2" type="revolute"><parent link="left_l1"/><child link="left_l2"/><origin xyz="0 0 0.4" rpy="1.5707963267948966 0 0"/><axis xyz="0 1 0"/><limit lower="-2.9670597283903604" upper="2.9670597283903604" effort="50" velocity="3.141592653589793"/></joint></robot>"#,
    },
    Case {
        name: "namespaces",
        files: &[(
            "robot.xacro",
            r#"<robot name="n" xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:drake="http://drake.mit.edu">
  <xacro:property name="J" value="5e-5"/>
  <xacro:property name="N" value="113.90625"/>
  <xacro:macro name="drive" params="joint">
    <transmission name="${joint}_t"><joint name="${joint}"/><actuator name="${joint}_m"><mechanicalReduction>${N}</mechanicalReduction><drake:rotor_inertia value="${J}"/></actuator></transmission>
  </xacro:macro>
  <xacro:drive joint="a"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot xmlns:drake="http://drake.mit.edu" name="n"><transmission name="a_t"><joint name="a"/><actuator name="a_m"><mechanicalReduction>113.90625</mechanicalReduction><drake:rotor_inertia value="5e-05"/></actuator></transmission></robot>"#,
    },
    Case {
        name: "ns_nested",
        files: &[
            (
                "robot.xacro",
                r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="k" value="5"/><xacro:include filename="a.xacro" ns="a"/><v x="${a.x}" b="${a.b.y}"/><xacro:a.m/><xacro:a.b.n q="1"/></robot>"#,
            ),
            (
                "a.xacro",
                r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="x" value="${k * 2}"/><xacro:include filename="b.xacro" ns="b"/><xacro:macro name="m" params=""><v in="${x}"/></xacro:macro></robot>"#,
            ),
            (
                "b.xacro",
                r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="y" value="3"/><xacro:macro name="n" params="q"><v q="${q}" y="${y}"/></xacro:macro></robot>"#,
            ),
        ],
        arguments: &[],
        expected: r#"<robot name="t"><v x="10" b="3"/><v in="10"/><v q="1" y="3"/></robot>"#,
    },
    Case {
        name: "quotes",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="p" value="''"/><xacro:property name="s" value="'a b'"/><v p="[${p}]" s="${s}" c="${s + p + 'x'}" l="${len(s)}" t="${'true' if p == '' else 'false'}"/><xacro:macro name="m" params="a:='' b:='x y' c:=true d:=1.50"><v a="[${a}]" b="${b}" c="${c}" d="${d}" k="${not c}"/></xacro:macro><xacro:m/><xacro:m c="false" d="'1.50'"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v p="[]" s="a b" c="a bx" l="3" t="true"/><v a="[]" b="x y" c="True" d="1.5" k="False"/><v a="[]" b="x y" c="False" d="1.50" k="True"/></robot>"#,
    },
    Case {
        name: "numbers",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="a" value="1.0"/><xacro:property name="b" value="007"/><xacro:property name="c" value=" 3 "/><xacro:property name="d" value="1e3"/><xacro:property name="e" value="-.5"/><xacro:property name="f" value="+4"/><xacro:property name="g" value="inf"/><v a="${a}" b="${b}" c="${c}" d="${d}" e="${e}" f="${f}" aa="${a*2}" g="${g}" r="$(arg z)" z="${$(arg z)/4}" t="${1e22}" u="${123456789012345680.0}" w="${1/3}" x="${-0.0}" y="${2**0.5}" q="${10**-3}"/>
</robot>"#,
        )],
        arguments: &["z:=2"],
        expected: r#"<robot name="t"><v a="1.0" b="7" c="3" d="1000.0" e="-0.5" f="4" aa="2.0" g="inf" r="2" z="0.5" t="1e+22" u="1.2345678901234568e+17" w="0.3333333333333333" x="-0.0" y="1.4142135623730951" q="0.001"/></robot>"#,
    },
    Case {
        name: "texts",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<a>  ${1+1}  </a><b>x${2}y $${z} $(arg k)</b><c attr="a&#10;b"/><d attr="${'&lt;'}"/>
</robot>"#,
        )],
        arguments: &["k:=v"],
        expected: r#"<robot name="t"><a>2</a><b>x2y ${z} v</b><c attr="a&#10;b"/><d attr="&lt;"/></robot>"#,
    },
    Case {
        name: "lists",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="l" value="${[1,2,3]}"/><xacro:property name="m" value="${dict(a=[1,2], b='x')}"/><v l="${l}" m="${m}" s="${l[1:]}" n="${l[-2]}" j="${' '.join(['a','b'])}"/><v z="${m['b']}" k="${list(m.keys())}" in="${2 in l}" nin="${5 not in l}" e="${l == [1,2,3]}"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v l="[1, 2, 3]" m="{'a': [1, 2], 'b': 'x'}" s="[2, 3]" n="2" j="a b"/><v z="x" k="['a', 'b']" in="True" nin="True" e="True"/></robot>"#,
    },
    Case {
        name: "conds",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="n" value="None"/><xacro:if value="${n == 'None'}"><v a="1"/></xacro:if><xacro:if value="${[]}"><v a="2"/></xacro:if><xacro:unless value="${'' or 0.0}"><v a="3"/></xacro:unless><xacro:if value="${'1'}"><v a="4"/></xacro:if><xacro:if value="true"><xacro:if value="False"><v/></xacro:if><v a="5"/></xacro:if>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v a="1"/><v a="3"/><v a="4"/><v a="5"/></robot>"#,
    },
    Case {
        name: "args",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="a" default="${1+1}"/><xacro:arg name="b" default="$(arg a)x"/><xacro:property name="c" default="$(arg b)"/><v a="$(arg a)" b="$(arg b)" c="${c}" d="${'$(arg b)' == '2x'}" e="${$(arg a) == 2}"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v a="2" b="2x" c="2x" d="True" e="True"/></robot>"#,
    },
    Case {
        name: "elem",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="e" params="n *b"><xacro:element xacro:name="${n}"><xacro:insert_block name="b"/></xacro:element></xacro:macro><xacro:e n="q"><z/></xacro:e><xacro:element xacro:name="xacro:e" n="r"><z/></xacro:element>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><q><z/></q><r><z/></r></robot>"#,
    },
    Case {
        name: "lazy",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="a" value="${b}"/><xacro:property name="b" value="1"/><v a="${a}"/><xacro:property name="b" value="2"/><v a="${a}"/><xacro:property name="a" value="${b}"/><xacro:macro name="m" params="b"><v a="${a}" b="${b}"/></xacro:macro><xacro:m b="7"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v a="1"/><v a="1"/><v a="2" b="7"/></robot>"#,
    },
    Case {
        name: "forward",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="p" value="outer"/><xacro:macro name="m" params="p:=^|none q:=^|${p}x"><v p="${p}" q="${q}"/></xacro:macro><xacro:m/><xacro:macro name="k" params=""><xacro:property name="p" value="inner"/><xacro:m/></xacro:macro><xacro:k/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v p="outer" q="outerx"/><v p="inner" q="innerx"/></robot>"#,
    },
    Case {
        name: "mathfun",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<v a="${math.floor(2.7)}" b="${math.pi}" c="${pow(2,3)}" d="${fabs(-2)}" e="${exp(1)}" f="${log(10)}" g="${atan2(1,-1)}" h="${fmod(7,3)}" i="${copysign(1,-2)}" j="${hypot(3,4)}" k="${trunc(-2.5)}" l="${max(1,2.0)}" m="${round(-1.5)}" n="${round(1.25,1)}" o="${int(-3.7)}" p="${str(1.0)}" q="${float('2')}" r="${7.5 // 2}" s="${-7.5 % 2}" t="${5 % -3}" u="${log(8,2)}" v="${tau}"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v a="2" b="3.141592653589793" c="8.0" d="2.0" e="2.718281828459045" f="2.302585092994046" g="2.356194490192345" h="1.0" i="-1.0" j="5.0" k="-2" l="2.0" m="-2" n="1.2" o="-3" p="1.0" q="2.0" r="3.0" s="0.5" t="-1" u="3.0" v="6.283185307179586"/></robot>"#,
    },
    Case {
        name: "param_space",
        files: &[(
            "robot.xacro",
            r#"<robot name="t" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="m" params="a  b := 2
  c:= 3 d =4 e:='5 6'"><v a="${a}" b="${b}" c="${c}" d="${d}" e="${e}"/></xacro:macro><xacro:m a="1"/>
</robot>"#,
        )],
        arguments: &[],
        expected: r#"<robot name="t"><v a="1" b="2" c="3" d="4" e="5 6"/></robot>"#,
    },
];
